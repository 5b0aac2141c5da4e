// A mask in hand: strokes with hard edges on a clear ground, undo, drafts, saves.
import type { Desk } from "./desk";
import { json, send } from "./server";
import type { Place } from "./sheet";

const SOON_MS = 800;
/** Steps that can be undone. */
const STEPS = 40;

export class Painting {
  readonly canvas: OffscreenCanvas;
  private readonly context: OffscreenCanvasRenderingContext2D;
  private version: string | null = null;
  private stroke: { last: Place; radius: number; color: string | null } | null = null;
  private readonly before: ImageData[] = [];
  private readonly after: ImageData[] = [];
  private timer = 0;
  private isDirty = false;
  private isKept = true;

  constructor(
    private readonly id: string,
    private readonly desk: Desk,
    private readonly size: [number, number],
  ) {
    this.canvas = new OffscreenCanvas(...size);
    const context = this.canvas.getContext("2d", { willReadFrequently: true });
    if (!context) throw new Error("this browser draws no pictures; use a current one");
    this.context = context;
  }

  get dirty(): boolean {
    return this.isDirty;
  }

  async load() {
    const shown = await json<{ version: string | null; saved: string | null; draft: string | null; stale_draft: string | null }>(`document/${this.id}`);
    this.version = shown.version;
    this.isDirty = shown.draft !== null;
    if (shown.saved === null && shown.draft === null) return;
    const picture = await createImageBitmap(await (await fetch(`picture/${this.id}`)).blob());
    if (picture.width !== this.size[0] || picture.height !== this.size[1]) {
      throw new Error(`the mask has ${picture.width} × ${picture.height} px, its image ${this.size.join(" × ")}`);
    }
    this.context.drawImage(picture, 0, 0);
    clearGround(this.context, ...this.size);
    if (this.isDirty) this.desk.say("Restored what was not saved.");
  }

  private whole(): ImageData {
    return this.context.getImageData(0, 0, ...this.size);
  }

  /** Begins a stroke; without a colour it erases. */
  begin(at: Place, radius: number, color: string | null) {
    this.before.push(this.whole());
    if (this.before.length > STEPS) this.before.shift();
    this.after.length = 0;
    this.stroke = { last: at, radius, color };
    this.go(at);
  }

  /** Goes on with the stroke: discs along the way, pixel by pixel, since a mask has no soft edges. */
  go(at: Place) {
    if (!this.stroke) return;
    const { last, radius, color } = this.stroke;
    const steps = Math.max(1, Math.ceil((2 * Math.hypot(at.x - last.x, at.y - last.y)) / radius));
    for (let step = 0; step <= steps; step++) {
      const share = step / steps;
      this.disc(last.x + share * (at.x - last.x), last.y + share * (at.y - last.y), radius, color);
    }
    this.stroke.last = at;
  }

  private disc(x: number, y: number, radius: number, color: string | null) {
    this.context.fillStyle = color ?? "#000";
    for (let row = Math.ceil(y - radius); row <= y + radius; row++) {
      const half = Math.sqrt(radius * radius - (row - y) ** 2);
      const [first, last] = [Math.ceil(x - half), Math.floor(x + half)];
      if (last < first) continue;
      if (color) this.context.fillRect(first, row, last - first + 1, 1);
      else this.context.clearRect(first, row, last - first + 1, 1);
    }
  }

  end() {
    if (!this.stroke) return;
    this.stroke = null;
    this.touched();
  }

  undo() {
    this.step(this.before, this.after);
  }
  redo() {
    this.step(this.after, this.before);
  }

  private step(from: ImageData[], to: ImageData[]) {
    const image = from.pop();
    if (!image) return;
    to.push(this.whole());
    this.context.putImageData(image, 0, 0);
    this.touched();
  }

  private touched() {
    this.isDirty = true;
    this.isKept = false;
    clearTimeout(this.timer);
    this.timer = window.setTimeout(() => void this.keep(), SOON_MS);
    this.desk.say("Not saved yet.");
  }

  /** Keeps the mask as a draft; whether that was done. */
  async keep(): Promise<boolean> {
    clearTimeout(this.timer);
    if (this.isKept) return true;
    try {
      const bytes = await this.canvas.convertToBlob({ type: "image/png" });
      await send("PUT", `draft/${this.id}?${this.desk.session.words(this.version)}`, bytes);
      this.isKept = true;
      return true;
    } catch (error) {
      this.desk.fail(`Not kept: ${(error as Error).message}`);
      return false;
    }
  }

  async save() {
    if (!(await this.keep())) return;
    try {
      const answer = await send("POST", `save/${this.id}?${this.desk.session.words(this.version)}`, null);
      const { version, is_changed } = (await answer.json()) as { version: string | null; is_changed: boolean };
      this.version = version;
      this.isDirty = false;
      this.desk.fail("");
      this.desk.say(is_changed ? "Saved." : "Saved; the file says the same as before.");
    } catch (error) {
      this.desk.fail(`Not saved: ${(error as Error).message}`);
    }
  }
}

/** Black ground, as other programs leave it, is made clear. */
export function clearGround(context: OffscreenCanvasRenderingContext2D, width: number, height: number) {
  const image = context.getImageData(0, 0, width, height);
  const { data } = image;
  for (let at = 0; at < data.length; at += 4) {
    if (Math.max(data[at], data[at + 1], data[at + 2]) < 32) data[at + 3] = 0;
  }
  context.putImageData(image, 0, 0);
}
