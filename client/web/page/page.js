// Selects the view from the fragment of the address, and sets the theme.
(function (ballpiston) {
  'use strict';

  const THEME = 'ballpiston-theme';
  const THEMES = ['auto', 'light', 'dark'];

  let leave = new AbortController();

  const main = () => document.getElementById('main');

  // Returns an empty text for a fragment that is not encoded correctly.
  function decoded(text) {
    try {
      return decodeURIComponent(text);
    } catch {
      return '';
    }
  }

  // {name, index} of #ensembleJobs/ID and #ensembleJobs/ID/results/INDEX; null for other addresses.
  function jobOf(fragment) {
    const match = /^(ensembleJobs\/[^/]+)(?:\/results\/(\d+))?$/.exec(fragment);
    return (
      match && {name: decoded(match[1]), index: match[2] === undefined ? null : Number(match[2])}
    );
  }

  function showView(fragment, signal) {
    const job = jobOf(fragment);
    if (job) return ballpiston.showJob(main(), job.name, job.index, signal);
    if (fragment === 'orbit') return ballpiston.showOrbit(main(), signal);
    return ballpiston.showJobs(main(), signal);
  }

  function markLink(fragment) {
    for (const link of document.querySelectorAll('nav a')) {
      const isCurrent = link.hash === `#${fragment || 'jobs'}`;
      if (isCurrent) link.setAttribute('aria-current', 'page');
      else link.removeAttribute('aria-current');
    }
  }

  // The banner already shows these errors. Other errors are defects of this page.
  function report(error) {
    if (error instanceof ballpiston.CallError || error?.name === 'AbortError') return;
    console.error(error);
  }

  // `change`: the event of a new fragment; undefined when the page opens.
  async function route(change) {
    ballpiston.takeToken(change && new URL(change.oldURL).hash);
    const fragment = location.hash.slice(1);
    leave.abort();
    leave = new AbortController();
    const {signal} = leave;
    ballpiston.removeCharts();
    main().replaceChildren();
    ballpiston.clearBanner();
    markLink(fragment);
    try {
      const shown = showView(fragment, signal);
      main().querySelector('h1')?.focus({preventScroll: true});
      scrollTo(0, 0);
      await shown;
    } catch (error) {
      if (!signal.aborted) report(error);
    }
  }

  function setUpTheme() {
    const storage = ballpiston.storage('localStorage');
    const stored = storage.getItem(THEME);
    const theme = THEMES.includes(stored) ? stored : 'auto';
    const chooser = ballpiston.choice(
      'Theme',
      THEMES.map((name) => ({value: name, label: name})),
      theme,
      (chosen) => {
        storage.setItem(THEME, chosen);
        ballpiston.setTheme(chosen);
      },
    );
    document.getElementById('theme').append(chooser);
    ballpiston.setTheme(theme);
  }

  setUpTheme();
  if (AbortSignal.any && CSS.supports('color', 'light-dark(red, red)')) {
    addEventListener('hashchange', route);
    route();
  } else {
    ballpiston.say(
      'This browser is too old. Use Chrome or Edge 123, Firefox 124, Safari 17.5 or newer.',
    );
  }
})((globalThis.ballpiston ??= {}));
