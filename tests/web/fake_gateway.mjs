// Answers that a real server gives rarely or never, as routes of a playwright page.
export const EVIL =
  '<img src=x onerror="window.wasAttacked = true"><script>window.wasAttacked = true</script>';

export function fakeJob(number, more = {}) {
  return {
    name: `ensembleJobs/${String(number).padStart(16, '0')}`,
    spec: {
      experiment: 'FIRST_HIT',
      grid: {rho: [0.5296], delta: [0.1], epsilon: [0.125], exponent: [1]},
      target: {samples: '1000'},
      seed: '0',
    },
    state: 'SUCCEEDED',
    progress: {points: 1, points_done: 1, samples: 1000, fraction: 1},
    principal: 'ada',
    create_time: new Date(1.7e12 + 1000 * number).toISOString(),
    ...more,
  };
}

const method = (name) => (url) => url.pathname === `/ballpiston.v1.${name}`;

// Lists `jobs`, which are in the order newest first, in pages of the requested size.
export async function listInstead(page, jobs) {
  await page.route(method('EnsembleService/ListEnsembleJobs'), async (route) => {
    const {page_size: size, page_token: token} = route.request().postDataJSON();
    const begin = Number(token || 0);
    const end = begin + size;
    await route.fulfill({
      json: {jobs: jobs.slice(begin, end), next_page_token: end < jobs.length ? String(end) : ''},
    });
  });
}

export async function answerInstead(page, name, json) {
  await page.route(method(name), (route) => route.fulfill({json}));
}

function envelope(flags, message) {
  const text = Buffer.from(JSON.stringify(message));
  const header = Buffer.alloc(5);
  header.writeUInt8(flags, 0);
  header.writeUInt32BE(text.length, 1);
  return Buffer.concat([header, text]);
}

// A complete stream with its end.
export async function streamInstead(page, name, messages) {
  const body = Buffer.concat([...messages.map((message) => envelope(0, message)), envelope(2, {})]);
  await page.route(method(name), (route) =>
    route.fulfill({contentType: 'application/connect+json', body}),
  );
}
