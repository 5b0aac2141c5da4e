// Which dot is which marker, in one frame of each camera.
import { choice, element, group } from "pages/elements";
import { type Dot, type Known, type Named, type Point, carried, dotsOf, nearest } from "./dots";
import { Held } from "./held";
import type { Desk, Tool } from "./desk";
import { type CameraImages, type Images, ask, json } from "./server";
import { Sheet, caption, picture } from "./sheet";
import { Waiting } from "./waiting";

interface Labels {
  take: Images["take"];
  frame: number;
  cameras: Record<string, Named>;
}

interface Hint extends Known {
  off_px: number | null;
}

/** A dot is snapped to from this far, px of the screen; farther clicks name the place itself. */
const SNAP_PX = 12;
/** A label this far off what other cameras say is doubtful, px. */
const OFF_PX = 3;

const parse = (text: string): Labels => JSON.parse(text).data;

function print({ take, frame, cameras }: Labels): string {
  const sorted = Object.keys(cameras).sort().map((camera) => {
    const dots = Object.entries(cameras[camera]).sort(([a], [b]) => (a < b ? -1 : 1));
    return [camera, Object.fromEntries(dots)] as const;
  });
  return `${JSON.stringify({ schema: "labels/1", data: { take, frame, cameras: Object.fromEntries(sorted.filter(([, dots]) => Object.keys(dots).length)) } })}\n`;
}

export async function labels(desk: Desk): Promise<Tool> {
  const images = await json<Images>("cameras");
  const first = Math.min(...images.cameras.map((camera) => camera.frames[0] ?? Infinity));
  const held = new Held<Labels>("labels", desk.session, () => ({ take: images.take, frame: first, cameras: {} }), parse, print);
  const page = new LabelsPage(desk, images, held);
  await page.start();
  return { element: page.element, sheet: page.sheet, held, keys: page.keys, close: () => {}, get busy() { return page.waiting.busy; } };
}

class LabelsPage {
  readonly element = element("div", { class: "desk" });
  readonly sheet = new Sheet("The image: click on a dot to name it, drag with the right button to move, wheel to enlarge");
  private readonly list = element("ul", { class: "list" });
  private readonly count = element("p", { class: "note" });
  private readonly frameInput = element("input", { type: "number" });
  private readonly nameInput = element("input", { id: "new-marker", placeholder: "marker", spellcheck: false, title: "Type a name to choose it, or to add it" });
  private readonly from = element("select", { title: "Camera to carry names over from" });
  private readonly message = element("p", { class: "note" });
  private camera: CameraImages;
  private dots: Dot[] = [];
  private hints: Record<string, Hint> = {};
  private guessed = new Set<string>();
  private marker = "";
  private names: string[] = [];
  private asked = 0;
  private isFinding = false;
  private isHinting = false;
  private isStale = false;
  readonly keys: Record<string, () => void>;
  readonly waiting = new Waiting();

  constructor(
    private readonly desk: Desk,
    private readonly images: Images,
    private readonly held: Held<Labels>,
  ) {
    this.camera = images.cameras[0];
    this.keys = {
      n: () => this.choose(1),
      p: () => this.choose(-1),
      Delete: () => this.clear(),
      f: () => this.sheet.fit(),
      c: () => this.carry(),
      a: () => this.accept(),
      "+": () => this.sheet.zoom(1.25),
      "-": () => this.sheet.zoom(0.8),
    };
    for (let number = 1; number <= Math.min(9, images.cameras.length); number++) {
      this.keys[`${number}`] = () => void this.look(images.cameras[number - 1]);
    }
  }

  async start() {
    await this.held.load();
    const known = await json<{ saved: string | null }>("document/picks").catch(() => ({ saved: null }));
    this.names = namesOf(known.saved ?? "");
    this.build();
    this.held.changed = (said) => {
      this.desk.say(said);
      this.show();
    };
    await this.look(this.camera);
  }

  private get here(): Named {
    return this.held.value.cameras[this.camera.id] ?? {};
  }

  /** All markers: those of the picks, and those that are named anywhere. */
  private markers(): string[] {
    const labelled = Object.values(this.held.value.cameras).flatMap((dots) => Object.keys(dots));
    return [...new Set([...this.names, ...labelled])].sort();
  }

  private build() {
    const cameras = choice("camera", this.images.cameras.map(({ id }) => [id, id] as [string, string]), this.camera.id, (id) => {
      const camera = this.images.cameras.find((camera) => camera.id === id);
      if (camera) void this.look(camera);
    });
    this.frameInput.addEventListener("change", () => {
      this.held.change((labels) => (labels.frame = this.frameInput.valueAsNumber));
      void this.look(this.camera);
    });
    this.nameInput.addEventListener("keydown", (event) => {
      const name = this.nameInput.value.trim();
      if (event.key !== "Enter" || !name) return;
      if (!this.markers().includes(name)) this.names.push(name);
      this.marker = name;
      this.nameInput.value = "";
      this.show();
      this.sheet.canvas.focus();
    });
    const button = (text: string, title: string, action: () => void) => {
      const made = element("button", { type: "button", title }, text);
      made.addEventListener("click", action);
      return made;
    };
    const panel = element("aside", { class: "panel" },
      group("Camera", cameras.set, element("label", { class: "row" }, "Frame", this.frameInput)),
      group("Markers", this.list, this.count,
        element("div", { class: "row" }, element("span", { class: "grow" }, this.nameInput), button("Clear", "Take this marker's label away (Delete)", () => this.clear()))),
      group("From another camera",
        element("div", { class: "row" }, this.from, button("Carry over", "Name the dots as in that camera (C)", () => this.carry()), button("Accept", "Keep all names that are guessed (A)", () => this.accept())),
        this.message),
      element("div", { class: "keys" }, ...keyHelp()));
    this.element.append(this.sheet.element, panel);
    this.sheet.over = (context, unit) => this.draw(context, unit);
    this.sheet.pressed = ({ x, y }, event) => this.press([x, y], event);
  }

  private look(camera: CameraImages): Promise<void> {
    return this.waiting.for(() => this.lookAt(camera));
  }

  /** Looks at a camera's image. */
  private async lookAt(camera: CameraImages) {
    this.camera = camera;
    const number = ++this.asked;
    const { frame } = this.held.value;
    this.frameInput.value = `${frame}`;
    this.dots = [];
    this.guessed.clear();
    try {
      const shown = await picture(`image/${camera.id}/${frame}`);
      if (number !== this.asked) return;
      this.sheet.show(shown);
    } catch (error) {
      this.sheet.show(null);
      this.desk.fail(`Frame ${frame} of camera ${camera.id}: ${(error as Error).message}`);
    }
    this.from.replaceChildren(...this.images.cameras.filter((other) => other !== camera).map(({ id }) => new Option(id)));
    const fullest = this.images.cameras.filter((other) => other !== camera).sort((a, b) => this.countOf(b.id) - this.countOf(a.id))[0];
    if (fullest) this.from.value = fullest.id;
    this.show();
    const paint = Object.values(this.here)[0];
    if (paint) await this.find(paint);
  }

  private countOf(camera: string): number {
    return Object.keys(this.held.value.cameras[camera] ?? {}).length;
  }

  /** Finds all dots of the paint at a place. */
  private async find(at: Point) {
    const number = this.asked;
    this.isFinding = true;
    try {
      const { table } = await ask<{ table: string }>("dots", { camera: this.camera.id, frame: this.held.value.frame, at });
      if (number !== this.asked) return;
      this.dots = dotsOf(table);
      this.sheet.draw();
    } catch (error) {
      this.desk.fail((error as Error).message);
    } finally {
      this.isFinding = false;
    }
  }

  private press(at: Point, event: PointerEvent): boolean {
    if (!this.desk.session.holds) return false;
    // Until the dots are found, further presses would be about nothing.
    if (this.isFinding) return true;
    if (this.dots.length === 0) void this.waiting.for(() => this.find(at)).then(() => this.name(at, event.altKey));
    else this.name(at, event.altKey);
    return true;
  }

  /** Names the dot at a place, or with `exactly` the place itself; a dot that has a name already is chosen. */
  private name(at: Point, exactly: boolean) {
    const dot = exactly ? null : nearest(this.dots, at, SNAP_PX * this.sheet.unit);
    const place: Point = dot?.at ?? [round(at[0]), round(at[1])];
    const taken = Object.entries(this.here).find(([, other]) => Math.hypot(other[0] - place[0], other[1] - place[1]) < 1);
    if (taken && taken[0] !== this.marker && this.here[this.marker]) {
      this.marker = taken[0];
      this.show();
      return;
    }
    if (!this.marker) {
      this.desk.say("Choose a marker in the list, or type a new name first.");
      this.nameInput.focus();
      return;
    }
    const { marker } = this;
    this.guessed.delete(marker);
    this.held.change(({ cameras }) => {
      const dots = (cameras[this.camera.id] ??= {});
      if (taken) delete dots[taken[0]];
      dots[marker] = place;
    });
    this.nextFree();
  }

  private clear() {
    const { marker } = this;
    this.held.change(({ cameras }) => delete cameras[this.camera.id]?.[marker]);
  }

  /** The next marker of the list without a dot here. */
  private nextFree() {
    const all = this.markers();
    const start = all.indexOf(this.marker);
    const order = [...all.slice(start + 1), ...all.slice(0, start + 1)];
    this.marker = order.find((marker) => !(marker in this.here)) ?? this.marker;
    this.show();
  }

  private choose(step: number) {
    const all = this.markers();
    this.marker = all[(all.indexOf(this.marker) + step + all.length) % all.length] ?? "";
    const at = this.here[this.marker];
    if (at) this.sheet.reveal({ x: at[0], y: at[1] });
    this.show();
  }

  private carry() {
    const from = this.held.value.cameras[this.from.value] ?? {};
    if (this.dots.length === 0) {
      this.message.textContent = "Name one dot here first, so that the paint's colour is known.";
      return;
    }
    const found = carried(from, this.here, this.dots, this.hints);
    const names = Object.keys(found);
    this.message.textContent = names.length
      ? `${names.length} names carried over; look at them, then accept (A).`
      : "Nothing is sure enough: name three dots or more here, far from each other.";
    this.held.change(({ cameras }) => Object.assign((cameras[this.camera.id] ??= {}), found));
    this.guessed = new Set(names);
    this.sheet.draw();
  }

  private accept() {
    this.guessed.clear();
    this.message.textContent = "";
    this.nextFree();
  }

  /** Asks what other cameras say; what is asked while an answer is awaited is asked once, after it. */
  private async hint() {
    if (this.isHinting) {
      this.isStale = true;
      return;
    }
    this.isHinting = true;
    do {
      this.isStale = false;
      const camera = this.camera.id;
      const found = await ask<Record<string, Hint>>("hints", { labels: this.held.value.cameras, camera }).catch(() => ({}));
      if (camera === this.camera.id) this.hints = found;
      else this.isStale = true;
    } while (this.isStale);
    this.isHinting = false;
    this.showList();
    this.sheet.draw();
  }

  private show() {
    const all = this.markers();
    if (!all.includes(this.marker)) this.marker = all.find((marker) => !(marker in this.here)) ?? all[0] ?? "";
    this.showList();
    this.sheet.draw();
    void this.waiting.for(() => this.hint());
  }

  private isDoubtful(marker: string): boolean {
    return (this.hints[marker]?.off_px ?? 0) > OFF_PX && marker in this.here;
  }

  private showList() {
    const rows = this.markers().map((marker) => {
      const elsewhere = this.images.cameras.filter(({ id }) => marker in (this.held.value.cameras[id] ?? {})).length;
      const off = this.hints[marker]?.off_px;
      const state = this.isDoubtful(marker)
        ? element("span", { class: "bad numbers", title: "How far off what the other cameras say" }, `${off?.toFixed(1)} px`)
        : element("span", { class: "quiet numbers", title: "Cameras that have it" }, `${elsewhere}`);
      const row = element("li", {}, element("span", { class: "name" }, marker), element("span", {}, marker in this.here ? (this.guessed.has(marker) ? "?" : "●") : ""), state);
      row.setAttribute("aria-selected", `${marker === this.marker}`);
      row.addEventListener("click", () => {
        this.marker = marker;
        const at = this.here[marker];
        if (at) this.sheet.reveal({ x: at[0], y: at[1] });
        this.show();
      });
      return row;
    });
    this.list.replaceChildren(...rows);
    this.list.querySelector('[aria-selected="true"]')?.scrollIntoView({ block: "nearest" });
    const lacking = this.markers().filter((marker) => this.images.cameras.filter(({ id }) => marker in (this.held.value.cameras[id] ?? {})).length < 2);
    this.count.textContent = `${Object.keys(this.here).length} here · ${lacking.length} in fewer than two cameras`;
  }

  private draw(context: CanvasRenderingContext2D, unit: number) {
    context.lineWidth = unit;
    context.strokeStyle = "rgba(255,255,255,0.55)";
    for (const { at, area } of this.dots) ring(context, at, Math.max(Math.sqrt(area / Math.PI) + 2 * unit, 4 * unit));
    this.drawHint(context, unit);
    context.font = `${11 * unit}px system-ui, sans-serif`;
    for (const [marker, at] of Object.entries(this.here)) {
      const color = this.isDoubtful(marker) ? "#ff8a5c" : this.guessed.has(marker) ? "#ffd34d" : "#5ce08c";
      context.strokeStyle = context.fillStyle = color;
      context.lineWidth = (marker === this.marker ? 2.5 : 1.5) * unit;
      ring(context, at, 7 * unit);
      caption(context, marker, at[0] + 9 * unit, at[1] + 4 * unit, unit);
    }
  }

  /** Where the chosen marker must lie. */
  private drawHint(context: CanvasRenderingContext2D, unit: number) {
    const hint = this.hints[this.marker];
    if (!hint) return;
    context.strokeStyle = "#6cc5ff";
    context.lineWidth = 1.25 * unit;
    for (const piece of Object.values(hint.lines).flat()) {
      context.beginPath();
      piece.forEach(([x, y]) => context.lineTo(x, y));
      context.stroke();
    }
    if (!hint.at) return;
    const [x, y] = hint.at;
    context.beginPath();
    for (const [dx, dy] of [[1, 0], [0, 1]]) {
      context.moveTo(x - 10 * unit * dx, y - 10 * unit * dy);
      context.lineTo(x + 10 * unit * dx, y + 10 * unit * dy);
    }
    context.stroke();
  }
}

const round = (value: number) => Math.round(value * 100) / 100;

function ring(context: CanvasRenderingContext2D, [x, y]: Point, radius: number) {
  context.beginPath();
  context.arc(x, y, radius, 0, 2 * Math.PI);
  context.stroke();
}

/** Names in a table of picks. */
function namesOf(table: string): string[] {
  const rows = table.trim().split(/\r?\n/).map((row) => row.split(/[,;\t]/)[0].trim());
  return rows.filter((name) => name && name.toLowerCase() !== "marker");
}

function keyHelp(): HTMLElement[] {
  const keys: [string, string][] = [
    ["Click", "name the dot; Alt: the very place"], ["N P", "next, previous marker"], ["Del", "take the label away"], ["1–9", "camera"],
    ["C A", "carry over, accept"], ["F + −", "fit, enlarge, reduce"], ["Ctrl Z Y", "undo, redo"], ["Ctrl S", "save"],
  ];
  return keys.flatMap(([key, what]) => [element("kbd", {}, key), element("span", {}, what)]);
}
