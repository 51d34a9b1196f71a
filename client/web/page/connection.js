// Storage, the token, retries, and the banner that says why the server does not answer. The page
// keeps its content until the server answers again.
(function (ballpiston) {
  'use strict';

  const TOKEN = 'ballpiston-token';
  const FIRST_DELAY = 500; // ms; doubles with each failure
  const LONGEST_DELAY = 8000;
  const LONGEST_HIDDEN = 5000; // ms, after which a stream of a hidden tab ends

  // `name`: localStorage or sessionStorage. Reading it throws if the browser blocks it; then values
  // last until the page is reloaded.
  function storage(name) {
    try {
      return globalThis[name];
    } catch {
      const values = new Map();
      return {getItem: (key) => values.get(key), setItem: (key, value) => values.set(key, value)};
    }
  }

  const session = storage('sessionStorage');
  const token = () => session.getItem(TOKEN) ?? '';

  // Moves the token from the address #token=... into this tab's storage: then bookmarks do not
  // contain it, and a reload keeps it. Then sets the fragment to `previous`, or to #jobs.
  function takeToken(previous) {
    const match = /^#token=([\w-]+)$/.exec(location.hash);
    if (!match) return;
    session.setItem(TOKEN, match[1]);
    history.replaceState(null, '', previous || '#jobs');
  }

  let isFinal = false; // the banner shows an error that a later answer does not remove

  function say(text, isFinalError = false) {
    const banner = document.getElementById('connection');
    isFinal = isFinalError;
    if (banner.textContent !== text) banner.textContent = text;
    banner.hidden = text === '';
  }

  // For a token of the page. The server may also require a token; ballpiston web sends that one.
  function adviceFor(error) {
    if (error.code === 'unauthenticated' && error.message.includes('ballpiston web')) {
      return 'Open the whole address that “ballpiston web” printed: it contains the token. ';
    }
    return '';
  }

  // Called when the reader acts.
  const clearBanner = () => say('');

  const failed = (error) => say(`${adviceFor(error)}The server says: ${error.message}`, true);
  function failedForNow(error) {
    if (isFinal) return;
    say(
      error.code === 'resource_exhausted'
        ? `Retrying. The server says: ${error.message}`
        : `No answer; retrying. The page may be out of date. Reason: ${error.message}`,
    );
  }

  // Waits for the next event of this name, or until the signal is aborted.
  function until(target, name, signal) {
    return new Promise((resolve) => {
      const ended = new AbortController(); // removes the listeners
      const end = () => {
        ended.abort();
        resolve();
      };
      target.addEventListener(name, end, {signal: ended.signal});
      signal.addEventListener('abort', end, {signal: ended.signal});
      if (signal.aborted) end();
    });
  }

  // Waits until `ms` have passed, or the browser is online again, or the signal is aborted.
  const pause = (ms, signal) =>
    until(window, 'online', AbortSignal.any([signal, AbortSignal.timeout(ms)]));

  // Waits until this tab is visible. A hidden tab sends no requests: a browser keeps only six
  // connections to the gateway, for all tabs together.
  async function visible(signal) {
    while (document.hidden && !signal.aborted) await until(document, 'visibilitychange', signal);
  }

  // Calls attempt(progress) until it succeeds or its error is final. The attempt calls progress()
  // when the server has answered. A final error is shown in the banner and thrown.
  async function keepTrying(attempt, signal) {
    let delay = FIRST_DELAY;
    const progress = () => {
      delay = FIRST_DELAY;
      if (!isFinal) say('');
    };
    for (;;) {
      await visible(signal);
      signal.throwIfAborted();
      try {
        const result = await attempt(progress);
        progress();
        return result;
      } catch (error) {
        signal.throwIfAborted();
        if (error instanceof TabHidden) continue;
        if (error.isFinal || !(error instanceof ballpiston.CallError)) {
          failed(error);
          throw error;
        }
        failedForNow(error);
      }
      await pause(delay, signal);
      delay = Math.min(2 * delay, LONGEST_DELAY);
    }
  }

  // Thrown by a stream that ended because its tab was hidden.
  class TabHidden extends Error {}

  // The messages of a stream. Ends the stream when the tab has been hidden for LONGEST_HIDDEN.
  async function* streamWhileVisible(method, request, signal) {
    const controller = new AbortController();
    let timer;
    const look = () => {
      clearTimeout(timer);
      if (!document.hidden) return;
      timer = setTimeout(() => controller.abort(new TabHidden()), LONGEST_HIDDEN);
    };
    document.addEventListener('visibilitychange', look, {signal: controller.signal});
    look();
    try {
      const either = AbortSignal.any([signal, controller.signal]);
      yield* ballpiston.stream(method, request, either);
    } finally {
      clearTimeout(timer);
      controller.abort(); // removes the listener
    }
  }

  Object.assign(ballpiston, {storage, token, takeToken, say, clearBanner});
  Object.assign(ballpiston, {until, pause, keepTrying, streamWhileVisible});
})((globalThis.ballpiston ??= {}));
