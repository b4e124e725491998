// SPDX-License-Identifier: Apache-2.0
// A headless Chromium, driven through chromedriver by the WebDriver protocol: no library is needed. And what tests of pages share.
import { spawn } from 'node:child_process';
import { readFileSync } from 'node:fs';

export const sleep = (milliseconds) => new Promise((resolve) => setTimeout(resolve, milliseconds));

function startDriver() {
  const driver = spawn('chromedriver', ['--port=0'], { stdio: ['ignore', 'pipe', 'inherit'] });
  return new Promise((resolve, reject) => {
    let said = '';
    driver.on('error', reject);
    driver.on('exit', () => reject(new Error(`chromedriver did not start: ${said}`)));
    driver.stdout.on('data', (chunk) => {
      said += chunk;
      const port = said.match(/successfully on port (\d+)/);
      if (port) resolve({ driver, url: `http://127.0.0.1:${port[1]}` });
    });
  });
}

async function request(url, method, body) {
  const response = await fetch(url, { method, headers: { 'Content-Type': 'application/json' },
    body: body === undefined ? undefined : JSON.stringify(body) });
  const { value } = await response.json();
  if (!response.ok) throw new Error(`${method} ${url}: ${value?.message ?? response.status}`);
  return value;
}

export async function openBrowser() {
  const { driver, url } = await startDriver();
  const { sessionId } = await request(`${url}/session`, 'POST', { capabilities: { alwaysMatch: {
    browserName: 'chrome',
    timeouts: { script: 300000, pageLoad: 300000 }, // milliseconds: beside other tests a frame drawn in software takes long
    'goog:chromeOptions': { args: ['--headless=new', '--no-sandbox', '--use-angle=swiftshader', '--enable-unsafe-swiftshader',
      '--disable-dev-shm-usage', '--disable-gpu-rasterization',
      '--disable-background-networking', '--disable-component-update', '--no-first-run', '--hide-scrollbars'] },
    'goog:loggingPrefs': { browser: 'ALL', performance: 'ALL' } } } });
  const session = `${url}/session/${sessionId}`;
  const devtools = (cmd, params = {}) => request(`${session}/goog/cdp/execute`, 'POST', { cmd, params });
  return {
    devtools,
    open: (page) => request(`${session}/url`, 'POST', { url: page }),
    // The body of a function of `args`, run in the page.
    run: (script, ...args) => request(`${session}/execute/sync`, 'POST', { script, args }),
    runAsync: (script, ...args) => request(`${session}/execute/async`, 'POST', { script, args }),
    // The body of a function that every page opened from now on runs before its own scripts.
    before: (script) => devtools('Page.addScriptToEvaluateOnNewDocument', { source: `(() => { ${script} })();` }),
    log: (type) => request(`${session}/se/log`, 'POST', { type }),
    size: (width, height) => devtools('Emulation.setDeviceMetricsOverride',
      { width, height, deviceScaleFactor: 1, mobile: false }),
    media: (media, scheme = 'light') => devtools('Emulation.setEmulatedMedia',
      { media, features: [{ name: 'prefers-color-scheme', value: scheme }] }),
    async close() {
      await request(session, 'DELETE').catch(() => {});
      driver.kill();
    },
  };
}

// Collects the sentences that do not hold.
export function makeJudge() {
  const judge = { failures: 0, holds(truth, sentence) {
    if (truth) return;
    judge.failures += 1;
    console.log(`does not hold: ${sentence}`);
  } };
  return judge;
}

// Judges the open page by axe, axe.min.js: what it finds serious does not hold.
export async function judgeByAxe(browser, axe, name, holds) {
  await browser.run(readFileSync(axe, 'utf8'));
  const found = await browser.runAsync(`const done = arguments[arguments.length - 1];
    axe.run(document, { resultTypes: ['violations'] }).then(({ violations }) => done(violations.map(({ id, impact, nodes }) =>
      ({ id, impact, first: nodes[0].html.slice(0, 160), why: nodes[0].failureSummary }))), (error) => done([{ id: String(error), impact: 'serious' }]));`);
  for (const { id, impact, first, why } of found)
    holds(impact !== 'serious' && impact !== 'critical', `axe, ${name}: ${impact} ${id}: ${first}: ${why}`);
}

// The console of all pages so far stays empty, and nothing is requested but what `allowed` matches.
export async function judgeLogs(browser, allowed, holds) {
  const errors = (await browser.log('browser')).filter(({ level }) => level === 'SEVERE' || level === 'WARNING');
  holds(errors.length === 0, `the console stays empty: ${JSON.stringify(errors.slice(0, 3))}`);
  const asked = (await browser.log('performance')).map(({ message }) => JSON.parse(message).message)
    .filter(({ method }) => method === 'Network.requestWillBeSent').map(({ params }) => params.request.url.split('#')[0]);
  const others = asked.filter((to) => !to.startsWith('data:') && !allowed(decodeURI(to)));
  holds(asked.length > 0 && others.length === 0, `pages request nothing that they do not contain: ${others.slice(0, 3)}`);
}
