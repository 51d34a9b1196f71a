// #ensembleJobs/ID and #ensembleJobs/ID/results/INDEX: a job while it runs. A watch sends its
// state, the running points, and each finished point. The page requests the histograms and curves
// of the shown point repeatedly, until that point is finished.
(function (ballpiston) {
  'use strict';

  const {element, button, call, keepTrying, POINT_COLUMNS, words} = ballpiston;

  const MOST_STEPS = 300; // of a point's convergence; then every second step is dropped
  const ROWS = 200; // of points that one press of a button adds
  const STATUS_EVERY = 2000; // ms between requests for the status, while the job waits
  const DETAILS_EVERY = 1000; // ms between requests for the details of an unfinished point
  const SHARE_OF_DRAWING = 4; // the pause after a drawing, in units of the drawing's duration
  const ENDED = new Set(['SUCCEEDED', 'FAILED', 'CANCELLED']);

  // ---- The known data of a job

  // The steps of a point's convergence: its estimates at increasing numbers of samples.
  function withStep(steps, {samples, estimates}) {
    if (!(samples > (steps.at(-1)?.samples ?? 0))) return steps;
    const longer = [...steps, {samples, estimates}];
    return longer.length > MOST_STEPS ? longer.filter((_, i) => i % 2 === 1) : longer;
  }

  // Null if there are fewer than two steps.
  function convergenceChart(allSteps, name) {
    const steps = allSteps
      .map((step) => ({samples: step.samples, ...ballpiston.estimateOf(step, name)}))
      .filter((step) => ballpiston.isNumber(step.value));
    if (steps.length < 2) return null;
    const {exact, limit, samples: most} = steps.at(-1);
    const places = steps.map(({samples: x, value, standard_error: error}) => {
      return {x, value, error, exact, limit, source: 'measured'};
    });
    return {
      title: `Convergence of ${words(name)}`,
      xLabel: 'samples',
      yLabel: 'value',
      lines: ballpiston.seriesLines(places),
      logX: most > 30 * steps[0].samples,
    };
  }

  // Jobs that the server answered from its store. Only the answer to CreateEnsembleJob says this.
  const fromStore = new Set();

  class JobRecord {
    constructor() {
      this.job = null;
      this.points = new Map(); // index: the newest data of the point
      this.finished = new Set();
      this.convergence = new Map(); // index: the steps
      this.newest = null; // index of the last updated point
    }

    takeJob(job) {
      const known = {answered_from_store: job.answered_from_store || fromStore.has(job.name)};
      const spec = this.job?.spec ?? job.spec; // a watch leaves out the grid
      this.job = {...job, ...known, spec};
    }

    takePoint(point, isFinished) {
      const before = this.points.get(point.index);
      if (!isFinished && this.finished.has(point.index)) return;
      if (isFinished) this.finished.add(point.index);
      // A watch sends no histograms and curves. The known ones are kept until newer ones arrive.
      const {histograms, curves} = before ?? point;
      this.points.set(point.index, before?.detailed ? before : {...point, histograms, curves});
      this.convergence.set(point.index, withStep(this.convergence.get(point.index) ?? [], point));
    }

    takeUpdate(update) {
      if (update.job) this.takeJob(update.job);
      if (!update.snapshot) return;
      const {progress, points = [], finished_points: finished = []} = update.snapshot;
      if (this.job && progress) this.job = {...this.job, progress};
      finished.forEach((point) => this.takePoint(point, true));
      points.forEach((point) => this.takePoint(point, false));
      this.newest = points[0]?.index ?? finished.at(-1)?.index ?? this.newest;
    }

    stateOf(point) {
      if (this.finished.has(point.index)) return '';
      return ENDED.has(this.job.state) ? ', unfinished: not kept' : ', running';
    }

    sorted() {
      return [...this.points.values()].sort((a, b) => a.index - b.index);
    }
  }

  // ---- The job itself

  function whyText(job, status) {
    switch (job.state) {
      case 'QUEUED':
        return (
          'The job waits until a worker is free. Each user gets an equal share of the workers. ' +
          'A user’s jobs with a higher priority run first. ' +
          (status ? ballpiston.statusText(status) : '')
        );
      case 'FAILED':
        return `The job failed: ${job.error?.message ?? 'no reason was given'}`;
      case 'CANCELLED':
        return 'The job was cancelled. Finished points are kept.';
      default:
        return status?.state === 'STORE_FAILING'
          ? 'The server cannot write to its disk. The job waits until results can be stored.'
          : '';
    }
  }

  // A command that the reader can copy.
  const command = (...words) =>
    element('pre', {tabindex: '0', class: 'command'}, words.map(ballpiston.shellWord).join(' '));

  function notes(job) {
    const stored = 'Answered from the store: the results were already there.';
    const expired = 'The results have expired. To compute the same numbers again:';
    const again = () => command('ballpiston', 'run', '--again', job.name);
    return [
      job.answered_from_store && element('p', {class: 'panel'}, stored),
      job.results_expired && element('div', {class: 'panel'}, element('p', {}, expired), again()),
    ].filter(Boolean);
  }

  class JobHead {
    constructor(onAsk) {
      this.title = element('h1', {tabindex: '-1'}, 'Job');
      this.progress = element('progress', {max: 1, value: 0, 'aria-label': 'Progress of the job'});
      this.progressText = element('span');
      this.state = element('span', {role: 'status'});
      this.why = element('p', {class: 'panel', hidden: true});
      this.notes = element('div');
      this.ask = button('Submit again', onAsk, {hidden: true});
      this.facts = element('div');
      this.spec = element('div');
      this.element = element(
        'section',
        {'aria-label': 'The job'},
        this.title,
        element('p', {class: 'progress'}, this.state, this.progress, this.progressText),
        this.why,
        this.notes,
        this.ask,
        element(
          'details',
          {class: 'about'},
          element('summary', {}, 'Specification, times and work'),
          this.spec,
          this.facts,
        ),
      );
    }

    show(job, status) {
      this.title.textContent = words(job.spec?.experiment);
      const state = ballpiston.stateText(job.state);
      document.title = `${words(job.spec?.experiment)}, ${state} – ballpiston`;
      const shown = `${job.state} ${job.answered_from_store} ${job.results_expired}`;
      if (this.state.dataset.shown !== shown) {
        this.state.dataset.shown = shown;
        this.state.replaceChildren(ballpiston.stateElement(job));
        this.notes.replaceChildren(...notes(job));
        this.spec.replaceChildren(ballpiston.specFacts(job.spec), ballpiston.specJson(job.spec));
      }
      const ended = ENDED.has(job.state);
      this.progress.hidden = ended;
      this.ask.hidden = !ended;
      this.progress.value = ballpiston.fractionOf(job.progress);
      this.progressText.textContent = ballpiston.progressText(job.progress);
      const why = whyText(job, status);
      this.why.hidden = why === '';
      if (this.why.textContent !== why) this.why.textContent = why;
      if (ended || !this.facts.firstChild) this.facts.replaceChildren(ballpiston.jobFacts(job));
    }
  }

  // ---- The points

  class PointTable {
    constructor(onChoose) {
      this.onChoose = onChoose;
      this.count = ROWS;
      this.table = ballpiston.table('Points, with their first estimate', POINT_COLUMNS, [], {
        class: 'rows points',
      });
      this.rows = new ballpiston.LiveRows(this.table, POINT_COLUMNS);
      const showMore = () => {
        this.count += ROWS;
        this.show(this.points, this.record, this.shown);
      };
      this.more = button('More points', showMore, {hidden: true});
      this.element = element('div', {}, this.table, this.more);
    }

    // Shows rows for the first `count` points.
    show(points, record, shown) {
      Object.assign(this, {points, record, shown});
      let next = this.rows.body.firstChild;
      for (const point of points.slice(0, this.count)) {
        const state = record.stateOf(point);
        const cells = () => this.cells(point, state);
        const seen = `${point.samples}${state}`;
        next = this.rows.put(point.index, seen, cells, next).nextSibling;
      }
      this.more.hidden = points.length <= this.count;
      const [shownCount, count] = [this.count, points.length].map(ballpiston.countText);
      this.more.textContent = `More points (${shownCount} of ${count} are shown)`;
      this.marked?.removeAttribute('aria-current');
      this.marked = this.rows.rows.get(shown)?.row;
      this.marked?.setAttribute('aria-current', 'true');
    }

    cells(point, state) {
      const choose = () => this.onChoose(point.index);
      const link = button(`Point ${point.index}`, choose, {class: 'link'});
      return ballpiston.pointCells(point, element('span', {}, link, state));
    }
  }

  class PointPanel {
    constructor(onFollow) {
      this.title = element('h2', {tabindex: '-1'}, 'Point');
      this.follow = button('Follow the running point', onFollow);
      this.convergenceNote = element('p', {class: 'soft', hidden: true});
      this.view = new ballpiston.ResultView();
      const parts = [this.title, this.follow, this.view.element, this.convergenceNote];
      this.element = element('section', {'aria-label': 'One point', hidden: true}, parts);
    }

    show(point, record, isFollowing) {
      this.element.hidden = false;
      const isFinished = record.finished.has(point.index);
      this.title.textContent = `Point ${point.index}${record.stateOf(point)}`;
      this.follow.hidden = isFollowing || ENDED.has(record.job?.state);
      const convergence = point.estimates?.length
        ? convergenceChart(record.convergence.get(point.index) ?? [], point.estimates[0].name)
        : null;
      this.convergenceNote.hidden = convergence !== null || !(point.samples > 0);
      this.convergenceNote.textContent = isFinished
        ? 'Convergence is recorded while the page is open.'
        : '';
      this.view.show(point, convergence ? [convergence] : []);
    }

    // `index`: null if no point was chosen. `isFinal`: no further result will arrive.
    showMissing(index, job, isFinal) {
      this.element.hidden = index === null;
      const last = job.progress?.points - 1;
      this.title.textContent =
        index > last
          ? `There is no point ${index}: the last one is point ${last}`
          : `Point ${index} has no result${isFinal ? '' : ' yet'}`;
      this.follow.hidden = ENDED.has(job.state);
    }
  }

  // ---- The view

  class JobView {
    constructor(main, name, index, signal) {
      Object.assign(this, {
        name,
        signal,
        chosen: index,
        record: new JobRecord(),
        token: '',
        asked: new Set(), // indices of the points whose details are not requested again now
      });
      this.head = new JobHead(() => this.askAgain());
      this.grid = new ballpiston.GridChart();
      this.panel = new PointPanel(() => this.choose(null));
      this.points = new PointTable((chosen) => {
        this.choose(chosen);
        this.panel.title.scrollIntoView();
        this.panel.title.focus();
      });
      this.gridSection = element(
        'section',
        {'aria-label': 'All points', hidden: true},
        element('h2', {}, 'All points'),
        this.grid.element,
        this.points.element,
      );
      main.append(this.head.element, this.panel.element, this.gridSection);
    }

    // `index` null: the running point, or the first point.
    choose(index) {
      this.chosen = index;
      const result = index === null ? '' : `/results/${index}`;
      history.replaceState(null, '', ballpiston.addressOf({name: this.name}) + result);
      this.draw();
    }

    get shown() {
      const {job, newest} = this.record;
      const isActive = job && !ENDED.has(job.state);
      return this.chosen ?? (isActive ? newest : this.lastShown) ?? 0;
    }

    draw() {
      const {record} = this;
      if (!record.job) return;
      this.head.show(record.job, this.status);
      const points = record.sorted();
      this.gridSection.hidden = points.length < 2;
      if (points.length > 1) {
        this.grid.show(points);
        this.points.show(points, record, this.shown);
      }
      const point = record.points.get(this.shown);
      if (!point) {
        this.panel.showMissing(this.chosen, record.job, this.hasAll);
        return;
      }
      this.lastShown = this.shown;
      this.panel.show(point, record, this.chosen === null);
      this.askForDetails(point);
    }

    // Draws soon. Waits longer if drawing takes long.
    drawSoon() {
      if (this.drawing) return;
      this.drawing = true;
      const draw = () => {
        const begin = performance.now();
        if (!this.signal.aborted) this.draw();
        this.took = performance.now() - begin;
        this.drawing = false;
      };
      setTimeout(() => requestAnimationFrame(draw), SHARE_OF_DRAWING * (this.took ?? 0));
    }

    // Requests the histograms and curves of a point, which a watch does not send: those of a
    // finished point once, those of an unfinished point every DETAILS_EVERY ms.
    async askForDetails(point) {
      const {record, asked} = this;
      const {index} = point;
      const isFinished = record.finished.has(index);
      const isLost = !isFinished && ENDED.has(record.job.state);
      if (point.detailed || record.job.results_expired || isLost || asked.has(index)) return;
      asked.add(index);
      const request = {name: `${this.name}/results/${index}`, unfinished: !isFinished};
      const ask = () => call('EnsembleService/GetResult', request, this.signal);
      if (isFinished) {
        // Null after an error: the banner shows the error, or the view has changed.
        const detailed = await keepTrying(ask, this.signal).catch(() => null);
        if (detailed) record.points.set(index, {...detailed, detailed: true});
      } else {
        // The call fails if the point is finished or not begun. Then the next snapshot updates it.
        const now = await ask().catch(() => null);
        const known = record.points.get(index);
        const {histograms, curves} = now ?? known;
        if (!known.detailed) record.points.set(index, {...known, histograms, curves});
        this.drawSoon();
        await ballpiston.pause(DETAILS_EVERY, this.signal);
        asked.delete(index);
      }
      this.drawSoon();
    }

    // One watch until the job's end. Resumes where the last watch stopped.
    async watch(progress) {
      const updates = ballpiston.streamWhileVisible(
        'EnsembleService/WatchEnsembleJob',
        {name: this.name, resume_token: this.token},
        this.signal,
      );
      for await (const update of updates) {
        progress();
        this.token = update.resume_token ?? this.token;
        this.record.takeUpdate(update);
        this.drawSoon();
      }
    }

    // Submits the same specification: the server answers from its store, or computes.
    async askAgain() {
      this.head.ask.disabled = true;
      ballpiston.clearBanner();
      const request = {spec: this.record.job.spec, request_id: crypto.randomUUID()};
      const create = () => call('EnsembleService/CreateEnsembleJob', request, this.signal);
      // Null after an error: the banner shows the error, or the view has changed.
      const job = await keepTrying(create, this.signal).catch(() => null);
      this.head.ask.disabled = false;
      if (!job) return;
      if (job.answered_from_store) fromStore.add(job.name);
      if (job.name !== this.name) location.hash = ballpiston.addressOf(job);
      this.record.takeJob(this.record.job);
      this.drawSoon();
    }

    async watchStatus() {
      while (!this.signal.aborted && !ENDED.has(this.record.job?.state)) {
        if (!document.hidden) {
          this.status = await call('ServerService/GetServerStatus', {}, this.signal).catch(
            () => this.status,
          );
          this.drawSoon();
        }
        await ballpiston.pause(STATUS_EVERY, this.signal);
      }
    }

    // A watch of an ended job sends the job last, and no watch sends the grid. Therefore the page
    // first requests the job.
    async run() {
      const {name, signal} = this;
      const ask = () => call('EnsembleService/GetEnsembleJob', {name}, signal);
      this.record.takeJob(await keepTrying(ask, signal));
      this.drawSoon();
      this.watchStatus();
      await keepTrying((progress) => this.watch(progress), this.signal);
      this.hasAll = true;
      this.drawSoon();
    }
  }

  function showJob(main, name, index, signal) {
    document.title = 'Job – ballpiston';
    return new JobView(main, name, index, signal).run();
  }

  Object.assign(ballpiston, {showJob});
})((globalThis.ballpiston ??= {}));
