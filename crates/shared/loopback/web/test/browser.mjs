// A real headless Chromium for the tests of pages: what goes wrong in a page, and what it hands to the graphics card, is noted.
import { existsSync } from "node:fs";
import { chromium } from "playwright-core";

const PLACES = ["/usr/bin/chromium-headless-shell", "/usr/bin/chromium", "/usr/bin/chromium-browser"];

/** Complaints that are kept. */
const MOST = 10;

/** Counts what goes to textures, in the page. */
function countUploads() {
  globalThis.uploads = 0;
  for (const name of ["texImage2D", "texImage3D", "texSubImage2D", "texSubImage3D", "texStorage2D", "texStorage3D", "compressedTexImage2D", "copyTexImage2D"]) {
    const original = WebGL2RenderingContext.prototype[name];
    WebGL2RenderingContext.prototype[name] = function (...words) {
      globalThis.uploads += 1;
      return original.apply(this, words);
    };
  }
}

/** Opens pages in one browser; `errors` collects what the pages complain of. */
export async function browser() {
  const executablePath = process.env.FURROW_BROWSER ?? PLACES.find(existsSync);
  if (!executablePath) throw new Error("there is no Chromium");
  const process_ = await chromium.launch({ executablePath, args: ["--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--ignore-gpu-blocklist"] });
  const errors = [];
  const note = (text) => errors.length < MOST && !errors.includes(text) && errors.push(text);
  const open = async (url, options = {}) => {
    const context = await process_.newContext({ viewport: { width: 1280, height: 720 }, ...options });
    const page = await context.newPage();
    page.on("console", (message) => {
      if (["error", "warning"].includes(message.type()) && !/GPU stall due to ReadPixels|GL Driver Message/.test(message.text())) note(`console: ${message.text()}`);
    });
    page.on("pageerror", (error) => note(`page: ${error.message}`));
    page.on("requestfailed", (request) => note(`request: ${request.url()}`));
    page.on("response", (response) => response.status() >= 400 && note(`${response.status()}: ${response.url()}`));
    await page.addInitScript(countUploads);
    await page.goto(url);
    await page.waitForSelector("body[data-ready], body[data-failed]", { state: "attached", timeout: 60_000 });
    return page;
  };
  return { open, errors, close: () => process_.close() };
}
