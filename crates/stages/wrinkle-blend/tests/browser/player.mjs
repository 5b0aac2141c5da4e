// Drives the player's page: node player.mjs URL FOLDER [STATES]. STATES: JSON, a list of { poses, clip, frame }.
// Writes per state NUMBER.rgba (the blended map of the shader) and NUMBER.json (size, shares), pictures of the page, and prints what was
// found as one line of JSON.
import { writeFileSync } from "node:fs";
import { join } from "node:path";
import { browser } from "../../../../shared/loopback/web/test/browser.mjs";

const [url, folder, states = "[]"] = process.argv.slice(2);
const { open, errors, close } = await browser();

/** A short word for what the canvas shows. */
const seen = (page) =>
  page.evaluate(async () => {
    await new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)));
    const text = document.getElementById("view").toDataURL();
    const digest = await crypto.subtle.digest("SHA-256", new TextEncoder().encode(text));
    return [...new Uint8Array(digest)].slice(0, 8).map((byte) => byte.toString(16)).join("");
  });

async function maps(page) {
  for (const [number, state] of JSON.parse(states).entries()) {
    const found = await page.evaluate(({ poses, clip, frame }) => {
      player.set(poses, clip ?? null, frame ?? 0);
      const { width, height, data } = player.blended();
      let text = "";
      for (let at = 0; at < data.length; at += 32768) text += String.fromCharCode(...data.subarray(at, at + 32768));
      return { width, height, shares: player.shares(), data: btoa(text) };
    }, state);
    const { data, ...rest } = found;
    writeFileSync(join(folder, `${number}.rgba`), Buffer.from(data, "base64"));
    writeFileSync(join(folder, `${number}.json`), JSON.stringify(rest));
  }
}

/** What sliders, boxes, buttons and keys do to the picture. */
async function controls(page) {
  const still = await seen(page);
  const uploads = await page.evaluate(() => uploads);
  await page.locator("#pose-0").focus();
  for (let press = 0; press < 10; press++) await page.keyboard.press("PageUp");
  const moved = await seen(page);
  const value = await page.evaluate(() => player.state.poses[0]);
  await page.keyboard.press("w");
  const smooth = await seen(page);
  await page.keyboard.press("w");
  await page.keyboard.press("i");
  const influence = await seen(page);
  await page.keyboard.press("s");
  const back = await seen(page);
  await page.locator("#view").focus();
  await page.keyboard.press("ArrowLeft");
  const turned = await seen(page);
  await page.keyboard.press("r");
  await page.keyboard.press("0");
  await page.waitForFunction(() => player.state.poses.every((share) => share === 0));
  const rest = await seen(page);
  const after = await page.evaluate(() => uploads);
  return {
    slider_moves: moved !== still && value > 0.5, wrinkles_show: smooth !== moved, influence_shows: influence !== moved, looks_come_back: back === moved,
    keys_turn: turned !== moved, neutral_comes_back: rest === still, uploads_while_moving: after - uploads, uploads_at_start: uploads,
  };
}

async function expressions(page) {
  const found = {};
  for (const button of await page.locator(".buttons button:not([disabled])").all()) {
    await button.click();
    await page.waitForTimeout(500);
    found[await button.textContent()] = await seen(page);
  }
  return found;
}

const page = await open(url);
const failed = await page.evaluate(() => ("failed" in document.body.dataset ? document.getElementById("notice").textContent : null));
const found = { failed };
if (!failed) {
  await maps(page);
  await page.evaluate(() => player.set(player.scene.poses.map(() => 0)));
  Object.assign(found, await controls(page));
  found.expressions = Object.keys(await expressions(page)).length;
  await page.screenshot({ path: join(folder, "light.png") });
  found.timings = await page.locator("#timings").textContent();
  found.overflows = await page.evaluate(() => document.documentElement.scrollWidth > innerWidth || document.getElementById("panel").scrollHeight > innerHeight);
  // A second time, in another window, dark: both live.
  const other = await open(url, { colorScheme: "dark" });
  await other.evaluate(() => player.set(player.scene.poses.map((_, pose) => (pose === 0 ? 1 : 0))));
  await seen(other);
  await other.screenshot({ path: join(folder, "dark.png") });
  found.two_live = (await page.evaluate(() => player.state.poses.length)) === (await other.evaluate(() => player.state.poses.length));
}
console.log(JSON.stringify({ ...found, errors }));
await close();
