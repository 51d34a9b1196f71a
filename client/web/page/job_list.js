// #jobs: the jobs, newest first. The first page of the list is requested every two seconds, further
// pages on demand. Rows outside the window are not laid out (content-visibility in style.css).
(function (ballpiston) {
  'use strict';

  const {element, button, table, LiveRows, call, keepTrying, pause, countText, words} = ballpiston;

  const PAGE = 100;
  const REFRESH = 2000; // ms
  const MOST_CALLS = 20; // for one page: with a filter a call may return no job, but more follow
  const MOST_ASKED = 5; // jobs outside the first page that one refresh requests

  const STATES = {
    QUEUED: 'waits',
    RUNNING: 'runs',
    CANCELLING: 'is being cancelled',
    SUCCEEDED: 'succeeded',
    FAILED: 'failed',
    CANCELLED: 'cancelled',
  };

  const FILTERS = {
    all: [],
    active: ['QUEUED', 'RUNNING', 'CANCELLING'],
    succeeded: ['SUCCEEDED'],
    failed: ['FAILED'],
    cancelled: ['CANCELLED'],
  };

  const COLUMNS = ballpiston.textColumns('Job', 'State', 'Progress', 'Created', 'Principal');

  const stateText = (state) => STATES[state] ?? words(state);

  function stateElement(job) {
    return element('span', {class: 'state', 'data-state': job.state}, stateText(job.state));
  }

  // page.js decodes the address. An id may contain any characters.
  const addressOf = (job) => `#ensembleJobs/${encodeURIComponent(ballpiston.idOf(job))}`;

  // The share of the work that is done; the share of finished points if the work is not known.
  function fractionOf(progress) {
    if (!progress?.points) return 0;
    return progress.fraction ?? progress.points_done / progress.points;
  }

  function progressText(progress) {
    const {points = 0, points_done: done = 0, samples = 0} = progress ?? {};
    const share =
      done < points && progress?.fraction > 0 ? `, ${Math.floor(100 * progress.fraction)} %` : '';
    return (
      `${countText(done)} of ${countText(points)} ${points === 1 ? 'point' : 'points'}${share}` +
      (samples > 0 ? `, ${countText(samples)} samples` : '')
    );
  }

  function progressCell(job) {
    if (job.state !== 'RUNNING') return progressText(job.progress);
    return element(
      'span',
      {class: 'progress'},
      element('progress', {max: 1, value: fractionOf(job.progress), 'aria-label': 'Progress'}),
      progressText(job.progress),
    );
  }

  const NOTES = {
    pinned: 'pinned',
    results_expired: 'results expired',
    answered_from_store: 'answered from the store',
  };

  function cellsOf(job) {
    const link = element('a', {href: addressOf(job)}, words(job.spec?.experiment));
    const id = element('code', {class: 'soft'}, ballpiston.idOf(job));
    const notes = Object.keys(NOTES).filter((name) => job[name]);
    const note = notes.map((name) => NOTES[name]).join(', ');
    return [
      element('span', {}, link, ' ', id),
      element('span', {}, stateElement(job), note && element('span', {class: 'soft'}, ` ${note}`)),
      progressCell(job),
      ballpiston.timeElement(job.create_time) ?? '',
      job.principal ?? '',
    ];
  }

  // The rows of jobs, by the job's name, newest job first.
  class JobRows extends LiveRows {
    active = new Set(); // names of jobs that may change, the last updated one last

    clear() {
      this.rows.clear();
      this.active.clear();
      this.body.replaceChildren();
    }

    remove(name) {
      super.remove(name);
      this.active.delete(name);
    }

    putJob(job, next) {
      this.active.delete(job.name);
      if (FILTERS.active.includes(job.state)) this.active.add(job.name);
      return this.put(job.name, JSON.stringify(job), () => cellsOf(job), next);
    }

    // Updates the rows from a new answer for the first page. Adds new jobs at the top. Removes jobs
    // that were deleted or no longer match the filter. `isAll`: no job follows this page.
    refresh(jobs, isAll) {
      const names = new Set(jobs.map((job) => job.name));
      const oldest = jobs.at(-1)?.create_time ?? '';
      for (const [name, {row}] of this.rows) {
        const isNewer = jobs.length > 0 && row.querySelector('time')?.dateTime > oldest;
        if (!names.has(name) && (isAll || isNewer)) this.remove(name);
      }
      let next = this.body.firstChild;
      for (const job of jobs) {
        const row = this.putJob(job, next);
        if (row === next || !next?.isConnected) next = row.nextSibling;
      }
    }

    refreshTimes() {
      const now = Date.now();
      for (const time of this.body.querySelectorAll('time')) {
        const text = ballpiston.ageText(new Date(time.dateTime), now);
        if (time.textContent !== text) time.textContent = text;
      }
    }
  }

  function statusText(status) {
    const jobs = (count) => `${countText(count)} ${count === 1 ? 'job' : 'jobs'}`;
    const state =
      {
        DRAINING: ' The server is stopping: it accepts no jobs.',
        STORE_FAILING: ' The server cannot write to its disk.',
      }[status.state] ?? '';
    const cluster = status.cluster?.problem ? ` Cluster: ${status.cluster.problem}.` : '';
    return (
      `${status.busy_workers} of ${status.workers} workers are busy; ` +
      `${jobs(status.running_jobs)} running, ${jobs(status.queued_jobs)} waiting, ` +
      `${jobs(status.stored_jobs)} stored.${state}${cluster}`
    );
  }

  class JobList {
    constructor(main, signal) {
      this.signal = signal;
      this.filter = 'all';
      this.status = element('p', {class: 'soft'});
      const list = table('Jobs, newest first', COLUMNS, [], {class: 'rows jobs'});
      this.rows = new JobRows(list, COLUMNS);
      this.empty = element('p', {hidden: true});
      this.more = button('More jobs', () => this.appendPage(), {hidden: true});
      const names = Object.keys(FILTERS).map((name) => ({value: name, label: name}));
      const filter = ballpiston.choice('State', names, 'all', (name) => this.setFilter(name));
      const choices = element('div', {class: 'choices'}, filter);
      const title = element('h1', {tabindex: '-1'}, 'Jobs');
      main.append(title, this.status, choices, list, this.empty, this.more);
    }

    setFilter(name) {
      this.filter = name;
      this.rows.clear();
      this.token = null;
      this.wake?.abort();
    }

    // One page of jobs. With a filter this can need several calls.
    async page(token) {
      const jobs = [];
      for (let calls = 0; calls < MOST_CALLS; ++calls) {
        const wanted = {page_size: PAGE - jobs.length, page_token: token, view: 'BASIC'};
        const request = {...wanted, states: FILTERS[this.filter]};
        const answer = await call('EnsembleService/ListEnsembleJobs', request, this.signal);
        jobs.push(...(answer.jobs ?? []));
        token = answer.next_page_token ?? '';
        if (token === '' || jobs.length >= PAGE) break;
      }
      return {jobs, token};
    }

    // Keeps the first answer's token of the next page: later jobs do not change it. But if no job
    // of the page is known, jobs may be missing between it and the rows: the list begins again.
    async refresh() {
      const filter = this.filter;
      const {jobs, token} = await this.page('');
      if (filter !== this.filter) return;
      if (jobs.length > 0 && !jobs.some((job) => this.rows.rows.has(job.name))) {
        this.rows.clear();
        this.token = null;
      }
      const names = new Set(jobs.map((job) => job.name));
      const others = [...this.rows.active].filter((name) => !names.has(name));
      this.rows.refresh(jobs, token === '');
      this.token ??= token;
      this.show();
      await Promise.all(others.slice(0, MOST_ASKED).map((name) => this.refreshJob(name)));
    }

    async refreshJob(name) {
      const asked = call('EnsembleService/GetEnsembleJob', {name}, this.signal);
      const job = await asked.catch((error) => {
        if (error.code !== 'not_found') throw error;
      });
      if (!this.rows.rows.has(name)) return;
      const states = FILTERS[this.filter];
      const isListed = job && (states.length === 0 || states.includes(job.state));
      if (isListed) this.rows.putJob(job, null);
      else this.rows.remove(name);
    }

    async appendPage() {
      if (this.loading) return;
      this.loading = true;
      ballpiston.clearBanner();
      const filter = this.filter;
      try {
        const from = this.token;
        const {jobs, token} = await keepTrying(() => this.page(from), this.signal);
        if (filter !== this.filter || from !== this.token) return;
        for (const job of jobs) this.rows.putJob(job, null);
        this.token = token;
        this.show();
      } finally {
        this.loading = false;
      }
    }

    show() {
      const count = this.rows.rows.size;
      this.more.hidden = !this.token;
      this.more.textContent = `More jobs (${countText(count)} are shown)`;
      this.empty.hidden = count > 0;
      this.empty.textContent =
        this.filter === 'all'
          ? 'There are no jobs. Submit one: ballpiston submit conditional-mean-free-time ' +
            '--rho 0.5296 --delta 0.1 --epsilon 0.1:0.4:4 --samples 1e6 --verify'
          : 'No job is in this state.';
    }

    async keepFresh() {
      while (!this.signal.aborted) {
        await keepTrying(async () => {
          await this.refresh();
          const status = await call('ServerService/GetServerStatus', {}, this.signal);
          this.status.textContent = statusText(status);
        }, this.signal);
        this.rows.refreshTimes();
        this.wake = new AbortController();
        await pause(REFRESH, AbortSignal.any([this.signal, this.wake.signal]));
      }
    }
  }

  function showJobs(main, signal) {
    document.title = 'Jobs – ballpiston';
    return new JobList(main, signal).keepFresh();
  }

  Object.assign(ballpiston, {showJobs, addressOf, stateElement});
  Object.assign(ballpiston, {stateText, fractionOf, progressText, statusText});
})((globalThis.ballpiston ??= {}));
