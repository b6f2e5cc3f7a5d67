// What the browser tests share: a browser, a page, and something that serves it: knurl-web at $KNURL_WEB_URL, or the stand-in.
import { existsSync } from "node:fs";
import { createRequire } from "node:module";
import { dirname, resolve } from "node:path";
import { fileURLToPath, pathToFileURL } from "node:url";

export const page = resolve(dirname(fileURLToPath(import.meta.url)), "../../apps/knurl-web/page");
const need = createRequire(resolve(page, "package.json"));
export const chromium = process.env.KNURL_CHROMIUM ?? "/usr/bin/chromium";

/** What is missing for these tests; "" where nothing is. */
export function missing(browser = true) {
  if (!existsSync(resolve(page, "node_modules/esbuild"))) return "no packages in apps/knurl-web/page/node_modules (scripts/page fetches them)";
  if (browser && !existsSync(chromium)) return `no ${chromium} (apt-get install chromium)`;
  return "";
}

export async function launch() {
  const { chromium: kind } = need("playwright-core");
  return kind.launch({
    executablePath: chromium,
    headless: true,
    args: ["--no-sandbox", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--disable-dev-shm-usage"],
  });
}
export async function mock(options) {
  const { Mock } = await import(pathToFileURL(resolve(page, "mock/server.mjs")).href);
  const server = new Mock(options);
  await server.start();
  return server;
}
/** A token is good for one login: later pages have its session. */
const sessions = new Map();
/** Opens the page, and collects what it should never say. */
export async function open(browser, url, options = {}) {
  const origin = new URL(url).origin;
  const context = await browser.newContext({ storageState: sessions.get(url), viewport: { width: 1400, height: 900 }, colorScheme: "dark", reducedMotion: "reduce", ...options });
  const tab = await context.newPage();
  const wrong = [];
  const outside = [];
  tab.on("pageerror", (error) => wrong.push(String(error)));
  tab.on("console", (message) => /Content Security Policy|Refused to/i.test(message.text()) && wrong.push(message.text()));
  tab.on("request", (request) => {
    const to = new URL(request.url());
    if (!["data:", "blob:"].includes(to.protocol) && to.origin !== origin) outside.push(request.url());
  });
  await tab.goto(sessions.has(url) ? `${origin}/` : url);
  sessions.set(url, await context.storageState());
  await tab.waitForFunction(() => window.knurl && document.readyState === "complete");
  return Object.assign(tab, { wrong, outside, context_: context });
}
