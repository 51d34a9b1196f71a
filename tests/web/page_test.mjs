// The page of `ballpiston web` and the page of a report, in Chromium, with the real programs.
// Tests wait for conditions, never for times.
import assert from 'node:assert/strict';
import {join} from 'node:path';
import {after, before, beforeEach, afterEach, describe, it} from 'node:test';
import axe from 'axe-core';
import {chromium} from 'playwright-core';
import {EVIL, answerInstead, fakeJob, listInstead, streamInstead} from './fake_gateway.mjs';
import {Programs} from './programs.mjs';

const CHROMIUM = process.env.CHROMIUM ?? '/usr/bin/chromium';
const ARGUMENTS =
  '--headless --no-sandbox --disable-gpu --disable-quic --no-first-run ' +
  '--disable-background-networking --disable-component-update --disable-sync';
const PHONE = {width: 390, height: 800};
const PATIENCE = 15 * 60000; // ms, the longest wait for a condition

const PAIR = '--rho 0.5296 --delta 0.1';

let programs, web, browser, context, page, mistakes;
let firstHit, gas; // names of finished jobs
let endless = []; // names of jobs that the test has submitted

before(async () => {
  programs = new Programs();
  web = await programs.web();
  firstHit = programs.run(
    `submit first-hit ${PAIR} --epsilon 0.125,0.3 --exponent 0,1 --samples 2e4`,
  );
  gas = programs.run(
    `submit gas-equilibrium ${PAIR} --cells 8 --temperature 1 --verify --samples 200`,
  );
  programs.run(`watch ${firstHit} --progress none`);
  programs.run(`watch ${gas} --progress none`);
  browser = await chromium.launch({executablePath: CHROMIUM, args: ARGUMENTS.split(' ')});
});

after(async () => {
  await browser?.close();
  await web?.stop();
  programs?.remove();
});

beforeEach(() => newPage());
afterEach(async () => {
  for (const job of endless.splice(0)) cancel(job);
  await context.close();
  assert.deepEqual(mistakes, []);
});

// `mistakes` are errors of the page's own scripts and violations of its content security policy. A
// failed call is not a mistake.
async function newPage(options = {}) {
  await context?.close();
  context = await browser.newContext({viewport: {width: 1200, height: 900}, ...options});
  page = await context.newPage();
  page.setDefaultTimeout(PATIENCE);
  mistakes = [];
  page.on('pageerror', (error) => mistakes.push(error.stack));
  page.on('console', (message) => {
    if (message.type() === 'error' && !message.text().startsWith('Failed to load resource')) {
      mistakes.push(message.text());
    }
  });
}

// Opens the page with the token, as a user does, and then the view.
async function open(view = 'jobs', address = web.address) {
  await page.goto(address);
  await page.waitForURL((url) => !url.hash.includes('token'));
  if (view !== 'jobs') await page.evaluate(`location.hash = '${view}'`);
  await page.getByRole('heading', {level: 1}).waitFor();
}

const banner = () => page.locator('#connection');
const jobLink = (job) => page.locator(`a[href="#${job}"]`);
const charts = () => page.locator('.chart canvas:not(.key)');
const pixelsOf = (locator) => locator.evaluate((canvas) => canvas.toDataURL());
const shown = (text) => page.getByText(text).first().waitFor();
const told = (text) => banner().filter({hasText: text}).waitFor();
const click = (button) => page.getByRole('button', {name: button}).click();
const refuseCreations = (answer) =>
  page.route('**/ballpiston.v1.EnsembleService/CreateEnsembleJob', (route) =>
    route.fulfill(answer),
  );

// A job that ends with the test.
function submitEndless(
  question = 'conditional-mean-free-time --epsilon 0.1,0.2 --tolerance 2e-6',
) {
  const job = programs.run(`submit ${question} ${PAIR} --model billiard`);
  endless.push(job);
  return job;
}

// Also a job that has ended.
function cancel(job) {
  try {
    programs.run(`cancel ${job}`);
  } catch (error) {
    assert.match(error.stderr, /JOB_ALREADY_ENDED/);
  }
}

async function waitUntilChanged(read, before) {
  await assertSoon(async () => assert.notEqual(await read(), before));
}

// Repeats `check` in each frame of the page until it succeeds without an exception.
async function assertSoon(check) {
  const end = Date.now() + PATIENCE;
  for (;;) {
    try {
      return await check();
    } catch (error) {
      if (Date.now() > end) throw error;
      await page.evaluate(() => new Promise(requestAnimationFrame));
    }
  }
}

async function assertNoViolations(where) {
  await page.evaluate(axe.source);
  const {violations} = await page.evaluate(() => axe.run());
  const found = violations.map(
    ({id, nodes}) => `${id}: ${nodes.map((node) => node.html).join(' | ')}`,
  );
  assert.deepEqual(found, [], where);
}

async function assertFitsTheWidth(where) {
  const excess = await page.evaluate(() => document.documentElement.scrollWidth - innerWidth);
  assert.ok(excess <= 0, `${where}: ${excess} pixels too wide`);
}

async function focusedText() {
  return page.evaluate(() => document.activeElement.textContent);
}

// Presses Tab until the focus is on an element with this text.
async function tabTo(text) {
  for (let i = 0; i < 60; ++i) {
    await page.keyboard.press('Tab');
    if ((await focusedText()) === text) return;
  }
  assert.fail(`the focus never came to ${text}`);
}

describe('The page', () => {
  it('removes the token from the address and sends no requests to other hosts', async () => {
    const hosts = new Set();
    page.on('request', (request) => hosts.add(new URL(request.url()).host));
    await open();
    await jobLink(firstHit).waitFor();
    assert.deepEqual([...hosts].filter(Boolean), [new URL(web.address).host]);
    assert.equal(new URL(page.url()).hash, '#jobs');
    await page.reload();
    await jobLink(firstHit).waitFor();
  });

  it('says that the address with the token is needed, and then shows the requested view', async () => {
    await page.goto(web.address.replace(/#.*/, `#${firstHit}/results/2`));
    await told('Authorization: Bearer TOKEN is missing');
    await told('Open the whole address');
    await page.goto(web.address);
    await page.getByRole('heading', {name: 'Point 2'}).waitFor();
    await banner().waitFor({state: 'hidden'});
  });

  it('shows a hostile name as text', async () => {
    const job = fakeJob(1, {
      name: `ensembleJobs/${EVIL}`,
      principal: EVIL,
      state: 'FAILED',
      error: {code: 9, message: EVIL},
      spec: {experiment: EVIL, grid: {cells: [EVIL]}, seed: EVIL},
      results_expired: true,
    });
    const point = {
      index: 0,
      parameters: {rho: 1, delta: 1, cells: EVIL},
      model: EVIL,
      samples: 1,
      reason: EVIL,
      remarks: [EVIL],
      estimates: [{name: EVIL, value: 1, standard_error: 1, exact: 1}],
    };
    await listInstead(page, [job]);
    await answerInstead(page, 'EnsembleService/GetEnsembleJob', job);
    await streamInstead(page, 'EnsembleService/WatchEnsembleJob', [
      {resume_token: '1', snapshot: {finished_points: [point, {...point, index: 1}]}},
      {job},
    ]);
    await open();
    await page.getByRole('cell', {name: EVIL, exact: true}).waitFor();
    await page.getByRole('link', {name: EVIL.toLowerCase()}).click();
    await page.getByRole('heading', {level: 1, name: EVIL.toLowerCase()}).waitFor();
    await page.getByText(`The job failed: ${EVIL}`).waitFor();
    await page.getByRole('heading', {name: 'Point 0'}).waitFor();
    assert.equal(await page.locator('img').count(), 0);
    assert.equal(await page.evaluate(() => window.wasAttacked), undefined);
  });
});

describe('Jobs', () => {
  it('submitted from the command line appear, and their charts move, without a reload', async () => {
    await open();
    await jobLink(firstHit).waitFor();
    await page.evaluate(() => {
      window.isTheSame = true;
    });
    const job = submitEndless();
    await jobLink(job).click();
    await shown('Convergence of mean free time conditional');
    const chart = charts().first();
    await chart.waitFor();
    await waitUntilChanged(() => pixelsOf(chart), await pixelsOf(chart));
    await page.getByText('Numbers').first().click();
    const rows = page.locator('.chart').first().locator('tbody tr');
    const count = await rows.count();
    await assertSoon(async () => assert.ok((await rows.count()) > count + 2));
    assert.equal(await page.evaluate(() => window.isTheSame), true);
    cancel(job);
    await shown('The job was cancelled');
    await page.getByRole('heading', {name: /^Point \d, unfinished: not kept$/}).waitFor();
  });

  it('show histograms with the exact law', async () => {
    await open(firstHit);
    await shown('Ingoing angle α, σ = −1');
    await shown('equilibrium law h⁽¹⁾, exact');
    await page.getByText('Numbers').first().click();
    const rows = await page.locator('.chart').first().locator('tbody tr').allInnerTexts();
    assert.equal(rows.length, 51); // 1000 bins in groups of 20, and the upper edge
    const area = page.locator('.u-over').first();
    const {width} = await area.boundingBox();
    await area.hover({position: {x: (20.8 / 50) * width, y: 9}});
    const read = await page.locator('.readout').first().innerText();
    assert.equal(read.split(' · ')[0], `α = ${rows[20].split('\t')[0]}`);
  });

  it('name different parameters, models without samples, and missing points', async () => {
    const job = fakeJob(1, {progress: {points: 4, points_done: 4}});
    const point = (index, delta, epsilon) => ({
      index,
      parameters: {delta, epsilon},
      model: 'CLOSED_FORM',
      estimates: [{name: 'mean_free_time', value: 2 + index, exact: 2}],
    });
    const finished = [point(0, 0.1, 0.5), point(1, 0.2, 0.5)];
    const near = [point(2, 0.1, 0.499999999999), point(3, 0.2, 0.499999999999)];
    await answerInstead(page, 'EnsembleService/GetEnsembleJob', job);
    const withExact = (label) => [label, `${label}, exact`];
    for (const [points, labels] of [
      [finished, ['closed form', 'exact']],
      [[...finished, ...near], ['ε = 0.5', 'ε = 0.499999999999'].flatMap(withExact)],
    ]) {
      await streamInstead(page, 'EnsembleService/WatchEnsembleJob', [
        {resume_token: '1', snapshot: {finished_points: points}},
        {job},
      ]);
      await open('jobs');
      await open(`${job.name}/results/4`);
      await page.getByRole('heading', {name: 'There is no point 4: the last one'}).waitFor();
      const legend = page.locator('.legend li');
      await assertSoon(async () => assert.deepEqual(await legend.allInnerTexts(), labels));
    }
  });

  it('show growing histograms while they run', async () => {
    await open(submitEndless('energy-relaxation --epsilon 0.3 --samples 1e12'));
    const chart = page.locator('.chart', {hasText: 'Energy of the piston'}).last();
    await chart.waitFor();
    const canvas = chart.locator('canvas:not(.key)');
    await waitUntilChanged(() => pixelsOf(canvas), await pixelsOf(canvas));
    const histogram = page.locator('.chart', {hasText: /Energy of the piston, time/}).first();
    const area = histogram.locator('.u-over');
    const {width} = await area.boundingBox();
    const shownAt = async (share) => {
      await area.hover({position: {x: share * width, y: 30}});
      return (await histogram.locator('.readout').innerText()).split(' · ')[0];
    };
    const middle = await shownAt(0.5);
    await page.mouse.down();
    await shownAt(0.9);
    await page.mouse.up();
    assert.equal(await shownAt(0.001), middle);
    const zoomed = histogram.locator('canvas:not(.key)');
    await waitUntilChanged(() => pixelsOf(zoomed), await pixelsOf(zoomed));
    await shownAt(0.2);
    assert.equal(await shownAt(0.001), middle);
  });

  it('show the reason of a wait', async () => {
    submitEndless();
    await answerInstead(page, 'EnsembleService/GetEnsembleJob', fakeJob(1, {state: 'QUEUED'}));
    await page.route(/WatchEnsembleJob/, () => {});
    await open('ensembleJobs/0000000000000001');
    await shown(/waits until a worker is free.*1 of 1 workers are busy/);
  });

  it('are listed by their state', async () => {
    const job = submitEndless();
    await open();
    await jobLink(firstHit).waitFor();
    await page.getByLabel('State').selectOption('active');
    await jobLink(firstHit).waitFor({state: 'detached'});
    await jobLink(job).waitFor();
    cancel(job);
    await jobLink(job).waitFor({state: 'detached'});
    await page.getByLabel('State').selectOption('cancelled');
    await jobLink(job).waitFor();
  });

  it('that came or ended since the last refresh of a long list are not lost', async () => {
    const jobs = Array.from({length: 150}, (_, i) => fakeJob(150 - i));
    jobs[120].state = 'RUNNING';
    await listInstead(page, jobs);
    await answerInstead(page, 'EnsembleService/GetEnsembleJob', jobs[120]);
    await open();
    const rows = page.locator('.jobs tbody tr');
    const more = page.getByRole('button', {name: 'More jobs'});
    await rows.first().waitFor();
    assert.equal(await rows.count(), 100); // only what the reader requested
    await more.click();
    await page.locator('[data-state=RUNNING]').waitFor();
    jobs[120] = {...jobs[120], state: 'CANCELLED'};
    await answerInstead(page, 'EnsembleService/GetEnsembleJob', jobs[120]);
    await page.locator('[data-state=CANCELLED]').waitFor();
    assert.equal(await rows.count(), 150);
    jobs.unshift(...Array.from({length: 130}, (_, i) => fakeJob(280 - i)));
    await jobLink(jobs[0].name).waitFor();
    for (let shown = 100; shown < 280; shown = await rows.count()) {
      assert.equal(await rows.count(), shown);
      await more.click();
      await assertSoon(async () => assert.ok((await rows.count()) > shown));
    }
    await more.waitFor({state: 'hidden'});
    assert.equal(await rows.count(), 280);
  });

  it('that do not exist are reported', async () => {
    await open('ensembleJobs/nothing');
    await told('no such job');
  });

  it('can be submitted again if they were cancelled', async () => {
    const job = submitEndless();
    cancel(job);
    await open(job);
    await click('Submit again');
    await page.waitForURL((url) => !url.href.includes(job));
    await shown('running');
    cancel(new URL(page.url()).hash.slice(1));
    await shown('The job was cancelled');
  });

  const details = [{debug: {reason: 'TOO_MANY_POINTS'}}];
  const refusal = {code: 'resource_exhausted', message: 'at most 10 points', details};
  for (const [what, answer, text] of [
    ['the gateway', {status: 413}, 'HTTP status 413'],
    ['the server', {status: 429, json: refusal}, 'at most 10 points'],
  ]) {
    it(`that are too large for ${what} are submitted once`, async () => {
      const watch = new Promise((begun) => page.route(/WatchEnsembleJob/, begun));
      await open(firstHit);
      await refuseCreations(answer);
      await click('Submit again');
      await told(`The server says: ${text}`);
      assert.ok(await page.getByRole('button', {name: 'Submit again'}).isEnabled());
      await (await watch).continue(); // the answer to another request leaves the reason on the page
      await page.getByRole('button', {name: 'Point 3'}).waitFor();
      assert.ok(await banner().isVisible());
    });
  }

  it('that the server refuses for now are submitted again, and answered from the store', async () => {
    await open(firstHit);
    const json = {code: 'resource_exhausted', message: 'too many jobs'};
    await refuseCreations({status: 429, json});
    await click('Submit again');
    await told('Retrying. The server says: too many jobs');
    await page.unrouteAll();
    await shown('Answered from the store');
    assert.ok(page.url().includes(firstHit));
  });

  it('with 10,000 points show 200 at a time', async () => {
    const job = programs.run('submit equilibrium --rho 0.51:0.7:100 --delta 0.001:0.01:100');
    programs.run(`watch ${job} --progress none`);
    await open(job);
    await page.getByText('10,000 are shown').waitFor();
    await page.getByText('6 of 100 lines, evenly selected').waitFor();
    assert.equal(await page.locator('.points tbody tr').count(), 200);
    await page.getByRole('button', {name: 'More points'}).press('Enter');
    await page.getByText('(400 of 10,000 are shown)').waitFor();
  });

  it('with expired results show the command that computes them again', async () => {
    const job = fakeJob(1, {results_expired: true});
    await answerInstead(page, 'EnsembleService/GetEnsembleJob', job);
    await open(job.name);
    await shown(`ballpiston run --again ${job.name}`);
  });
});

describe('When the server stops', () => {
  it('the data stay on the page, and the watch resumes after a restart', async () => {
    const job = submitEndless();
    await open(job);
    await shown('Convergence of');
    programs.stopServer();
    await told('No answer; retrying');
    const value = page.locator('.estimates td').nth(1);
    assert.notEqual(await value.innerText(), '');
    await page.getByText('Numbers').first().click();
    const rows = page.locator('.chart').first().locator('tbody tr');
    const known = await rows.count();
    programs.startServer();
    await banner().waitFor({state: 'hidden'});
    await assertSoon(async () => assert.ok((await rows.count()) > known));
  });

  it('and ballpiston web restarts with another token, the page says so', async () => {
    const own = await programs.web();
    await open('jobs', own.address);
    await jobLink(firstHit).waitFor();
    await own.stop();
    await told('ballpiston web no longer runs');
    const next = await programs.web(new URL(own.address).port);
    await told('Open the whole address');
    assert.ok(await jobLink(firstHit).isVisible());
    await page.goto(next.address);
    await banner().waitFor({state: 'hidden'});
    await next.stop();
  });
});

describe('Keyboard, colours and width', () => {
  it('a job and its points are reached with the keyboard alone', async () => {
    await open();
    await jobLink(firstHit).waitFor();
    await tabTo('Skip to the content');
    await tabTo('first hit');
    const outline = await page.evaluate(
      () => getComputedStyle(document.activeElement).outlineStyle,
    );
    assert.equal(outline, 'solid');
    await page.keyboard.press('Enter');
    await page.getByRole('button', {name: 'Point 3'}).waitFor();
    assert.equal(await focusedText(), 'first hit'); // the heading of the new view
    await tabTo('Point 3');
    await page.keyboard.press('Enter');
    await page.getByRole('heading', {name: 'Point 3'}).waitFor();
    assert.equal(await focusedText(), 'Point 3');
    assert.equal(new URL(page.url()).hash, `#${firstHit}/results/3`);
  });

  it('an orbit is played and paused with the keyboard alone', async () => {
    await open('orbit');
    const clock = page.locator('.readout').first();
    await clock.filter({hasText: 'events'}).waitFor();
    await waitUntilChanged(() => clock.innerText(), await clock.innerText());
    await tabTo('Trace');
    await tabTo(''); // the picture
    await page.keyboard.press(' ');
    await page.getByRole('button', {name: 'Play'}).waitFor();
    const paused = await clock.innerText();
    await page.keyboard.press('n');
    await waitUntilChanged(() => clock.innerText(), paused);
    await page.locator('.events li').first().filter({hasText: 'ball piston'}).waitFor();
    await page.getByLabel('δ').fill('0.01'); // the first exchange is event 19,098
    await page.getByRole('textbox', {name: 'Events'}).fill('1e5');
    await click('Trace');
    await clock.filter({hasText: 't = 0.00'}).waitFor();
    await click('Next exchange');
    await page.locator('.events li').first().filter({hasText: 'ball piston'}).waitFor();
  });

  it('an orbit does not move by itself for readers who prefer reduced motion', async () => {
    await newPage({reducedMotion: 'reduce'});
    await open('orbit');
    await page.locator('.readout').first().filter({hasText: 't = 0.00'}).waitFor();
    await page.getByRole('button', {name: 'Play'}).waitFor();
  });

  it('a gas is traced, and a parameter out of range is reported', async () => {
    await open('orbit');
    await page.getByLabel('Cells').fill('3x2');
    await page.getByLabel('δ').fill('0.15');
    await click('Trace');
    await page.getByRole('img', {name: 'Gas of 6 balls and 12 pistons'}).waitFor();
    await page.getByRole('textbox', {name: 'Events'}).fill('1e3');
    const request = page.waitForRequest(/TraceOrbit/);
    await click('Trace');
    assert.match((await request).postData(), /"events":1000\b/);
    for (const [field, wrong, right] of [
      ['Seed', '1e3', '7'],
      ['δ', '0,5', '0.9'],
    ]) {
      await page.getByLabel(field).fill(wrong);
      const form = page.locator('form.fields');
      assert.equal(await form.evaluate((fields) => fields.checkValidity()), false);
      await page.getByLabel(field).fill(right);
    }
    await click('Trace');
    await told('delta is 0.9');
  });

  it('the dark theme follows the system or the reader’s choice', async () => {
    const isDark = () =>
      page.evaluate(() => {
        const [red] = getComputedStyle(document.body).backgroundColor.match(/\d+/);
        return Number(red) < 64;
      });
    await newPage({colorScheme: 'dark'});
    await open(firstHit);
    await shown('Ingoing angle α, σ = −1');
    assert.ok(await isDark());
    const inDark = await pixelsOf(charts().first());
    await page.getByLabel('Theme').selectOption('light');
    assert.ok(!(await isDark()));
    await waitUntilChanged(() => pixelsOf(charts().first()), inDark);
    await page.reload();
    await page.getByRole('heading', {level: 1}).waitFor();
    assert.ok(!(await isDark()));
  });

  it('works in a browser that blocks storage', async () => {
    await context.addInitScript(() => {
      const get = () => {
        throw new DOMException('blocked', 'SecurityError');
      };
      Object.defineProperty(window, 'localStorage', {get});
      Object.defineProperty(window, 'sessionStorage', {get});
    });
    await open();
    await jobLink(firstHit).waitFor();
    await page.getByLabel('Theme').selectOption('dark');
    await page.locator('html[data-theme=dark]').waitFor();
  });
});

describe('Accessibility rules', () => {
  for (const [name, options] of Object.entries({
    light: {},
    dark: {colorScheme: 'dark'},
    phone: {viewport: PHONE},
  })) {
    it(`have no violations, ${name}; all views fit a phone`, async () => {
      const fits = options.viewport ? assertFitsTheWidth : () => {};
      const check = async (view) => {
        await fits(view);
        await assertNoViolations(view);
      };
      await newPage(options);
      await open();
      await jobLink(firstHit).waitFor();
      await check('jobs');
      await open(firstHit);
      await shown('Ingoing angle α, σ = −1');
      await fits('first hit');
      await page.getByText('Specification, times and work').click();
      await page.getByText('As JSON').click();
      await page.getByText('Numbers').first().click();
      await assertNoViolations('first hit');
      await open(gas);
      await shown('Speed of the balls');
      await check('gas');
      await open('orbit');
      await page.getByRole('img', {name: 'Cell with one ball'}).waitFor();
      await check('orbit');
      await page.goto(web.address.replace(/token=.*/, 'token=0123'));
      await told('wrong token');
      await assertNoViolations('an error');
    });
  }
});

// ---- The report

describe('A report', () => {
  it('shows its jobs without a network, also in the dark on a phone', async () => {
    const file = join(programs.folder, 'report.html');
    programs.run(`report ${firstHit} ${gas} --out`, file);
    await newPage({viewport: PHONE, colorScheme: 'dark'});
    const asked = [];
    page.on('request', (request) => asked.push(request.url()));
    await page.goto(`file://${file}`);
    await page.getByRole('heading', {name: 'first hit'}).waitFor();
    await page.getByRole('heading', {name: 'gas equilibrium'}).waitFor();
    await shown('Ingoing angle α, σ = −1');
    await shown('Speed of the balls');
    await charts().first().waitFor();
    assert.deepEqual(
      asked.filter((url) => !url.startsWith('data:')),
      [`file://${file}`],
    );
    await assertNoViolations('report');
    await assertFitsTheWidth('report');
  });
});
