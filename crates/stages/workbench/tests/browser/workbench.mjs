// Works at the pages as a person would: node workbench.mjs URL TRUTH [PICTURES]. TRUTH: labels (labels/1) to click at; PICTURES: a folder for
// pictures of the pages. Prints what was found as one line of JSON.
import { readFileSync } from "node:fs";
import { join } from "node:path";
import { browser } from "../../../../shared/loopback/web/test/browser.mjs";

const [url, truth, pictures] = process.argv.slice(2);
const { cameras } = JSON.parse(readFileSync(truth)).data;
const { open, errors, close } = await browser();
const page = await open(url);
const found = { label_s: 0, clicks: 0 };

/** Goes to a page of the workbench. */
async function go(id) {
  await page.evaluate((id) => {
    delete document.body.dataset.ready;
    location.hash = id;
  }, id);
  await page.waitForSelector("body[data-ready]", { state: "attached" });
  // Its place in the window is known only then.
  await page.evaluate(() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done))));
}

/** Where a place of the picture is in the window. */
const client = ([x, y]) => page.evaluate(([x, y]) => workbench.sheet.client({ x, y }), [x, y]);
const said = () => page.textContent("#state");
const picture = async (name) => pictures && (await page.screenshot({ path: join(pictures, `${name}.png`) }));
const settle = () => page.waitForFunction(() => !workbench.busy);

async function save() {
  await page.keyboard.press("Control+s");
  await page.waitForFunction(() => document.getElementById("state").textContent.startsWith("Saved"));
}

async function label() {
  await go("labels");
  const start = performance.now();
  for (const camera of ["m3", "m4"]) {
    await page.click(`input[name=camera][value=${camera}]`);
    await settle();
    let isFirst = true;
    for (const [marker, at] of Object.entries(cameras[camera])) {
      await page.fill("#new-marker", marker);
      await page.press("#new-marker", "Enter");
      // Beside the dot: it is snapped to.
      const { x, y } = await client([at[0] + 0.8, at[1] - 0.6]);
      await page.mouse.click(x, y);
      found.clicks += 1;
      // The first dot tells the paint's colour, and so all others.
      if (isFirst) await settle();
      isFirst = false;
    }
    await settle();
  }
  found.label_s = (performance.now() - start) / 1000;
  found.doubtful = await page.locator(".list .bad").count();
  await picture("labels");
  // A step back and forth changes nothing.
  await page.keyboard.press("Control+z");
  await page.keyboard.press("Control+y");
  await save();
}

async function pick() {
  await go("picks");
  await page.waitForSelector("canvas[data-complete]");
  await settle();
  found.fit = await page.locator("#warp").textContent();
  await page.locator(".list li", { hasText: "lip_corner_r" }).first().click();
  await page.keyboard.press("Delete");
  found.lacking = await page.locator("#count").textContent();
  await page.locator(".list li", { hasText: "lip_corner_r" }).first().click();
  await settle();
  await page.keyboard.press("m");
  await settle();
  await picture("picks");
  await save();
}

async function paint() {
  await go("paint");
  await settle();
  const size = await page.evaluate(() => workbench.sheet.size);
  const [from, to] = [await client([0.05 * size[0], 0.05 * size[1]]), await client([0.1 * size[0], 0.05 * size[1]])];
  await page.mouse.move(from.x, from.y);
  await page.mouse.down();
  await page.mouse.move(to.x, to.y, { steps: 5 });
  await page.mouse.up();
  found.painted = await said();
  await page.keyboard.press("Control+z");
  await save();
  found.unpainted = await said();
  await page.keyboard.press("t");
  await settle();
  found.learnt = await page.locator("#learnt").textContent();
  await picture("paint");
}

await picture("start");
await label();
await pick();
await paint();
// A second window only looks; the first one is told when it is taken over.
const second = await open(`${url}#labels`);
await second.waitForSelector("#take-over:visible");
found.second = await second.textContent("#notice");
console.log(JSON.stringify({ ...found, errors }));
await close();
