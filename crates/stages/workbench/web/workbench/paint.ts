// The paint of the wrinkles, marked in one image of each camera.
import { choice, element, group, slider } from "pages/elements";
import type { Desk, Tool } from "./desk";
import { Painting, clearGround } from "./painting";
import { type CameraImages, type Images, ask, json } from "./server";
import { type Place, Sheet, picture } from "./sheet";
import { Waiting } from "./waiting";

/** What marks a paint in a mask: any hue of its own; names are wrinkle-track's business. */
const PAINTS: [string, string][] = [["green", "#00ff00"], ["purple", "#ff00ff"], ["blue", "#0080ff"], ["yellow", "#ffff00"]];

export async function paint(desk: Desk): Promise<Tool> {
  const page = new PaintPage(desk, await json<Images>("cameras"));
  await page.start();
  return { element: page.element, sheet: page.sheet, held: page, keys: page.keys, close: () => {}, get busy() { return page.waiting.busy; } };
}

class PaintPage {
  readonly element = element("div", { class: "desk" });
  readonly sheet = new Sheet("The image: paint with the left button, erase with Alt, move with the right button");
  private readonly note = element("p", { id: "learnt", class: "note" });
  private readonly frameInput = element("input", { type: "number" });
  private camera: CameraImages;
  private frame: number;
  private painting: Painting | null = null;
  private preview: OffscreenCanvas | null = null;
  private color = PAINTS[0][1];
  private radius = 6;
  private showsMask = true;
  private cursor: Place | null = null;
  private asked = 0;
  readonly waiting = new Waiting();
  readonly keys: Record<string, () => void>;

  constructor(
    private readonly desk: Desk,
    private readonly images: Images,
  ) {
    const wide = images.cameras.filter((camera) => camera.id.startsWith("w"));
    this.camera = wide[0] ?? images.cameras[0];
    this.frame = this.camera.frames[0];
    this.keys = {
      "[": () => this.widen(-1), "]": () => this.widen(1), h: () => this.hide(), f: () => this.sheet.fit(), t: () => void this.waiting.for(() => this.train()),
      "+": () => this.sheet.zoom(1.25), "-": () => this.sheet.zoom(0.8),
    };
    PAINTS.forEach(([, color], number) => (this.keys[`${number + 1}`] = () => this.take(color)));
  }

  get dirty(): boolean {
    return this.painting?.dirty ?? false;
  }
  undo() {
    this.painting?.undo();
    this.sheet.draw();
  }
  redo() {
    this.painting?.redo();
    this.sheet.draw();
  }
  async save() {
    await this.painting?.save();
  }

  async start() {
    const cameras = choice("camera", this.images.cameras.map(({ id }) => [id, id] as [string, string]), this.camera.id, (id) => {
      const camera = this.images.cameras.find((camera) => camera.id === id);
      if (!camera) return;
      this.camera = camera;
      this.frame = camera.frames[0];
      void this.waiting.for(() => this.look());
    });
    this.frameInput.addEventListener("change", () => {
      this.frame = this.frameInput.valueAsNumber;
      void this.waiting.for(() => this.look());
    });
    const paints = choice("paint", PAINTS.map(([name, color]) => [color, name] as [string, string]), this.color, (color) => this.take(color));
    const width = slider("Brush", { least: 1, most: 40, step: 1, value: this.radius, text: (value) => `${2 * value} px` }, (value) => (this.radius = value));
    const light = slider("Light", { least: 0.5, most: 4, step: 0.1, value: 1, text: (value) => `× ${value.toFixed(1)}` }, (value) => {
      this.sheet.brightness = value;
      this.sheet.draw();
    });
    const button = (text: string, title: string, action: () => void) => {
      const made = element("button", { type: "button", title }, text);
      made.addEventListener("click", action);
      return made;
    };
    const keys: [string, string][] = [["Drag", "paint; Alt erases"], ["[ ]", "brush"], ["1–4", "which paint"], ["H", "hide what is marked"], ["T", "what would be learnt"], ["F + −", "fit, enlarge, reduce"], ["Ctrl Z Y S", "undo, redo, save"]];
    const panel = element("aside", { class: "panel" },
      group("Camera", cameras.set, element("label", { class: "row" }, "Frame", this.frameInput)),
      group("Paint", paints.set, width.row, light.row, element("p", { class: "note" }, "One colour per paint on the face. Mark all paint of this image, to its edge and not beyond: the rest counts as skin.")),
      group("What is learnt", element("div", { class: "row" }, button("Try", "Learn from what is marked, and show what it finds (T)", () => void this.waiting.for(() => this.train())), button("Hide", "Show and hide (H)", () => this.hide())), this.note),
      element("div", { class: "keys" }, ...keys.flatMap(([key, what]) => [element("kbd", {}, key), element("span", {}, what)])));
    this.element.append(this.sheet.element, panel);
    this.sheet.over = (context, unit) => this.draw(context, unit);
    this.sheet.pressed = (at, event) => this.press(at, event);
    this.sheet.moved = (at, event) => this.move(at, event);
    this.sheet.released = () => this.painting?.end();
    await this.look();
  }

  private async look() {
    const number = ++this.asked;
    await this.painting?.keep();
    this.frameInput.value = `${this.frame}`;
    this.preview = null;
    try {
      const shown = await picture(`image/${this.camera.id}/${this.frame}`);
      const painting = new Painting(`paint/${this.camera.id}`, this.desk, this.camera.size);
      await painting.load();
      if (number !== this.asked) return;
      this.painting = painting;
      this.sheet.show(shown);
    } catch (error) {
      this.desk.fail(`Frame ${this.frame} of camera ${this.camera.id}: ${(error as Error).message}`);
    }
  }

  private take(color: string) {
    this.color = color;
    this.sheet.draw();
  }

  private widen(step: number) {
    this.radius = Math.min(40, Math.max(1, this.radius + step));
    this.sheet.draw();
  }

  private hide() {
    this.showsMask = !this.showsMask;
    this.sheet.draw();
  }

  private press(at: Place, event: PointerEvent): boolean {
    if (!this.desk.session.holds || !this.painting) return false;
    this.preview = null;
    this.showsMask = true;
    this.painting.begin(at, this.radius, event.altKey ? null : this.color);
    this.sheet.draw();
    return true;
  }

  private move(at: Place, event: PointerEvent) {
    this.cursor = at;
    if (event.buttons & 1) this.painting?.go(at);
    this.sheet.draw();
  }

  /** Learns from all masks as they are, and shows what is taken for paint in this image. */
  private async train() {
    await this.painting?.keep();
    this.note.textContent = "Learning …";
    try {
      const learnt = await ask<Learnt>("learn", { camera: this.camera.id, frame: this.frame });
      this.preview = await clear(await picture("learnt"));
      this.note.textContent = told(learnt);
    } catch (error) {
      this.note.textContent = (error as Error).message;
    }
    this.sheet.draw();
  }

  private draw(context: CanvasRenderingContext2D, unit: number) {
    context.imageSmoothingEnabled = false;
    const layer = this.preview ?? this.painting?.canvas;
    if (layer && this.showsMask) {
      context.globalAlpha = 0.55;
      context.drawImage(layer, -0.5, -0.5);
      context.globalAlpha = 1;
    }
    if (!this.cursor) return;
    context.strokeStyle = this.color;
    context.lineWidth = 1.5 * unit;
    context.beginPath();
    context.arc(this.cursor.x, this.cursor.y, this.radius, 0, 2 * Math.PI);
    context.stroke();
  }
}

/** What `wrinkle-track train` says. */
interface Learnt {
  paints: Record<string, { score: number; pixels: number }>;
}

function told({ paints }: Learnt): string {
  const each = Object.entries(paints).map(([name, { score, pixels }]) => `${name}: ${(100 * score).toFixed(2)} % of held-out pixels told rightly, of ${pixels}`);
  return `${each.join("; ")}. Shown is what is taken for paint here; paint again to go back to the mask.`;
}

/** A mask on clear ground. */
async function clear(mask: ImageBitmap): Promise<OffscreenCanvas> {
  const canvas = new OffscreenCanvas(mask.width, mask.height);
  const context = canvas.getContext("2d");
  if (!context) throw new Error("this browser draws no pictures; use a current one");
  context.drawImage(mask, 0, 0);
  clearGround(context, canvas.width, canvas.height);
  return canvas;
}
