// A job's specification, times and work.
(function (ballpiston) {
  'use strict';

  const {element, facts, words, symbolOf} = ballpiston;
  const {countText, bytesText, durationText, wholeTime} = ballpiston;

  const MOST_VALUES = 12; // more values of a parameter are shortened in the table

  const idOf = (job) => String(job.name).split('/').slice(1).join('/');

  function gridText(values) {
    if (values.length <= MOST_VALUES) return values.join(', ');
    const first = values.slice(0, 3).join(', ');
    return `${first}, … ${values.at(-1)} (${countText(values.length)} values)`;
  }

  function targetText(target) {
    const parts = [];
    if (target?.samples !== undefined) parts.push(`${countText(target.samples)} samples per point`);
    if (target?.collisions !== undefined)
      parts.push(`${countText(target.collisions)} collisions per point`);
    if (target?.tolerance !== undefined) parts.push(`relative error ${target.tolerance}`);
    if (target?.budget)
      parts.push(`at most ${durationText(parseFloat(target.budget))} of computing time`);
    if (target?.estimate) parts.push(`of ${words(target.estimate)}`);
    return parts.join(', ') || '10,000 samples per point';
  }

  const chosen = (name) => (/UNSPECIFIED$/.test(name ?? '') ? null : words(name));

  function specFacts(spec) {
    const {table = [], ...lists} = spec?.grid ?? {};
    const grid = Object.entries(lists).filter(([, values]) => values.length);
    return facts([
      ...grid.map(([name, values]) => [symbolOf(name), gridText(values)]),
      ['Rows of a table', table.map(symbolOf).join(', ')],
      ['Target', targetText(spec?.target)],
      ['Model', chosen(spec?.model) ?? 'auto'],
      ['Precision', chosen(spec?.precision) ?? 'double'],
      ['Closed forms', spec?.verify ? 'verified by simulation' : null],
      ['Seed', spec?.seed],
    ]);
  }

  // The value without the fields that have their defaults.
  function shortened(value) {
    if (Array.isArray(value)) return value;
    if (typeof value !== 'object' || value === null) return value;
    const isDefault = (part) =>
      part === '' ||
      part === false ||
      part === null ||
      (Array.isArray(part) && part.length === 0) ||
      /UNSPECIFIED$/.test(part);
    return Object.fromEntries(
      Object.entries(value)
        .filter(([, part]) => !isDefault(part))
        .map(([name, part]) => [name, shortened(part)]),
    );
  }

  // The specification as JSON, for a file that --spec reads.
  function specJson(spec) {
    return element(
      'details',
      {class: 'spec'},
      element('summary', {}, 'As JSON, for --spec'),
      element(
        'pre',
        {tabindex: '0'},
        JSON.stringify(shortened(spec)).replaceAll(/,"(?=\w+":)/g, ',\n "'),
      ),
    );
  }

  function timeTaken(job) {
    if (!job.start_time || !job.end_time) return null;
    return durationText((new Date(job.end_time) - new Date(job.start_time)) / 1000);
  }

  function labelsText(labels) {
    return Object.entries(labels ?? {})
      .map(([key, value]) => `${key}=${value}`)
      .sort()
      .join(', ');
  }

  function jobFacts(job) {
    return facts([
      ['Job', element('code', {}, job.name)],
      ['Labels', labelsText(job.labels)],
      ['Continues', job.continues && element('code', {}, job.continues)],
      ['Principal', job.principal],
      ['Created', wholeTime(job.create_time)],
      ['Began', wholeTime(job.start_time)],
      ['Ended', wholeTime(job.end_time)],
      ['Took', timeTaken(job)],
      ['Processor time', job.work > 0 ? durationText(job.work) : null],
      ['Engine', job.engine_version],
      ['Priority', job.priority ? String(job.priority) : null],
      ['Stored', job.stored_bytes > 0 ? bytesText(job.stored_bytes) : null],
      [
        'Results expire',
        job.results_expired ? 'expired' : job.pinned ? 'never: pinned' : wholeTime(job.expire_time),
      ],
    ]);
  }

  Object.assign(ballpiston, {idOf, specFacts, specJson, jobFacts});
})((globalThis.ballpiston ??= {}));
