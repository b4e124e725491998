// SPDX-License-Identifier: Apache-2.0
// A headless Chromium, driven through chromedriver by the WebDriver protocol: no library is needed.
import { spawn } from 'node:child_process';

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
    'goog:chromeOptions': { args: ['--headless=new', '--no-sandbox', '--disable-gpu', '--disable-dev-shm-usage',
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
