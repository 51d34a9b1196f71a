// The page of `ballpiston report`: jobs with their points, from the JSON inside the page:
//   {client_version, created, jobs: [{job, points}]}
// with an EnsembleJob and PointResults, of which a long job has only the first ones.
(function (ballpiston) {
  'use strict';

  const {element, table, countText, words} = ballpiston;

  const MOST_PICTURED = 12; // points of a job with separate tables and pictures
  const MOST_ROWS = 1000; // of the table of all points

  const OUTCOMES = {
    SUCCEEDED: null,
    FAILED: 'This job failed',
    CANCELLED: 'This job was cancelled',
  };

  // Null if the job succeeded.
  function outcomeText(job) {
    if (!(job.state in OUTCOMES)) return 'This job had not ended when the report was made.';
    const text = OUTCOMES[job.state];
    return text && `${text}${job.error?.message ? `: ${job.error.message}` : '.'}`;
  }

  function panels(job, points) {
    const inTable = points.length > MOST_ROWS ? `the first ${countText(MOST_ROWS)}` : 'all';
    const leftOut = (job.progress?.points_done ?? 0) - points.length;
    return [
      outcomeText(job),
      job.results_expired || (leftOut > 0 && points.length === 0)
        ? 'The results have expired; only the specification is kept.'
        : null,
      leftOut > 0 && points.length > 0
        ? `${countText(leftOut)} further points are not in this report.`
        : null,
      points.length > MOST_PICTURED
        ? `The first ${MOST_PICTURED} of ${countText(points.length)} points have tables and pictures; ` +
          `the table at the end has ${inTable}.`
        : null,
    ]
      .filter(Boolean)
      .map((text) => element('p', {class: 'panel'}, text));
  }

  function pointTable(points) {
    const rows = points.slice(0, MOST_ROWS);
    const caption =
      'All points, with their first estimate' +
      (rows.length < points.length
        ? `: the first ${countText(rows.length)} of ${countText(points.length)}`
        : '');
    const cells = rows.map((point) => ballpiston.pointCells(point, String(point.index)));
    return table(caption, ballpiston.POINT_COLUMNS, cells, {class: 'rows points'});
  }

  // Call it when the section is in the page: charts need their width.
  function showPoint(section, point) {
    const view = new ballpiston.ResultView();
    section.append(
      element('h3', {}, `Point ${point.index}: ${ballpiston.parametersText(point.parameters)}`),
      view.element,
    );
    view.show(point);
  }

  function showGrid(section, points) {
    const grid = new ballpiston.GridChart();
    section.append(grid.element);
    if (!grid.show(points)) grid.remove();
  }

  function showJob(main, {job, points = []}) {
    const section = element(
      'section',
      {'aria-label': `${words(job.spec?.experiment)}, ${job.name}`},
      element('h2', {}, words(job.spec?.experiment)),
      panels(job, points),
      ballpiston.specFacts(job.spec),
      ballpiston.specJson(job.spec),
      ballpiston.jobFacts(job),
    );
    main.append(section);
    if (points.length > 1) showGrid(section, points);
    points.slice(0, MOST_PICTURED).forEach((point) => showPoint(section, point));
    if (points.length > 1) section.append(pointTable(points));
  }

  function showReport({client_version: version, created, jobs}) {
    const main = document.getElementById('main');
    main.append(
      element('h1', {}, jobs.length === 1 ? 'Report of a job' : `Report of ${jobs.length} jobs`),
      ballpiston.facts([
        ['Created', ballpiston.wholeTime(created)],
        ['Program', `ballpiston ${version}`],
      ]),
    );
    jobs.forEach((entry) => showJob(main, entry));
  }

  showReport(JSON.parse(document.getElementById('data').textContent));
})((globalThis.ballpiston ??= {}));
