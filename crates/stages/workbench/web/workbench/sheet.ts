// A picture to look at closely: moved with the mouse, enlarged with the wheel, with drawings over it in its own pixels.

export interface Place {
  x: number;
  y: number;
}

/** Pixel (0, 0) is the centre of the top-left pixel. */
export class Sheet {
  readonly element = document.createElement("div");
  readonly canvas = document.createElement("canvas");
  private picture: ImageBitmap | null = null;
  private scale = 1;
  private origin: Place = { x: 0, y: 0 };
  private asked = false;
  private isFitted = false;
  brightness = 1;
  /** Draws over the picture; lengths on the screen are `unit` pixels of the picture. */
  over: (context: CanvasRenderingContext2D, unit: number) => void = () => {};
  pressed: (at: Place, event: PointerEvent) => boolean = () => false;
  moved: (at: Place, event: PointerEvent) => void = () => {};
  released: (at: Place, event: PointerEvent) => void = () => {};

  constructor(label: string) {
    this.element.className = "sheet";
    this.canvas.tabIndex = 0;
    this.canvas.setAttribute("aria-label", label);
    this.element.append(this.canvas);
    new ResizeObserver(() => this.resized()).observe(this.element);
    this.canvas.addEventListener("wheel", (event) => this.wheel(event), { passive: false });
    this.canvas.addEventListener("pointerdown", (event) => this.down(event));
    this.canvas.addEventListener("pointermove", (event) => this.moved(this.at(event), event));
    this.canvas.addEventListener("contextmenu", (event) => event.preventDefault());
  }

  /** Shows a picture; the view stays where it is if the size stays. */
  show(picture: ImageBitmap | null) {
    const isNew = picture?.width !== this.picture?.width || picture?.height !== this.picture?.height;
    this.picture = picture;
    if (isNew) this.fit();
    this.draw();
  }

  get size(): [number, number] {
    return this.picture ? [this.picture.width, this.picture.height] : [0, 0];
  }

  /** Pixels of the picture to one of the screen. */
  get unit(): number {
    return 1 / this.scale;
  }

  /** The whole picture. */
  fit() {
    if (!this.picture) return;
    const { clientWidth: width, clientHeight: height } = this.element;
    // A sheet that is not on the page yet has no size; it is fitted once it has.
    this.isFitted = width > 0 && height > 0;
    this.scale = Math.min(width / this.picture.width, height / this.picture.height) || 1;
    this.origin = { x: (width - this.scale * this.picture.width) / 2, y: (height - this.scale * this.picture.height) / 2 };
    this.draw();
  }

  /** Enlarges about a place of the window. */
  zoom(factor: number, about = { x: this.element.clientWidth / 2, y: this.element.clientHeight / 2 }) {
    const scale = Math.min(64, Math.max(0.05, this.scale * factor));
    const ratio = scale / this.scale;
    this.origin = { x: about.x - ratio * (about.x - this.origin.x), y: about.y - ratio * (about.y - this.origin.y) };
    this.scale = scale;
    this.draw();
  }

  /** Brings a place of the picture into the window, if it is not well within. */
  reveal(at: Place) {
    const shown = { x: this.origin.x + this.scale * (at.x + 0.5), y: this.origin.y + this.scale * (at.y + 0.5) };
    const { clientWidth: width, clientHeight: height } = this.element;
    const isWithin = shown.x > 0.1 * width && shown.x < 0.9 * width && shown.y > 0.1 * height && shown.y < 0.9 * height;
    if (isWithin) return;
    this.origin = { x: this.origin.x + width / 2 - shown.x, y: this.origin.y + height / 2 - shown.y };
    this.draw();
  }

  /** Where an event is in the picture. */
  at(event: MouseEvent): Place {
    const box = this.canvas.getBoundingClientRect();
    return {
      x: (event.clientX - box.left - this.origin.x) / this.scale - 0.5,
      y: (event.clientY - box.top - this.origin.y) / this.scale - 0.5,
    };
  }

  /** Where a place of the picture is in the window, for who presses by a script. */
  client(at: Place): Place {
    const box = this.canvas.getBoundingClientRect();
    return { x: box.left + this.origin.x + this.scale * (at.x + 0.5), y: box.top + this.origin.y + this.scale * (at.y + 0.5) };
  }

  draw() {
    if (this.asked) return;
    this.asked = true;
    requestAnimationFrame(() => {
      this.asked = false;
      this.paint();
    });
  }

  private paint() {
    const context = this.canvas.getContext("2d");
    if (!context) return;
    const dense = devicePixelRatio || 1;
    context.setTransform(1, 0, 0, 1, 0, 0);
    context.clearRect(0, 0, this.canvas.width, this.canvas.height);
    context.setTransform(dense * this.scale, 0, 0, dense * this.scale, dense * this.origin.x, dense * this.origin.y);
    if (this.picture) {
      context.imageSmoothingEnabled = this.scale < 3;
      context.filter = this.brightness === 1 ? "none" : `brightness(${this.brightness})`;
      context.drawImage(this.picture, 0, 0);
      context.filter = "none";
    }
    context.translate(0.5, 0.5);
    this.over(context, 1 / this.scale);
  }

  private resized() {
    const dense = devicePixelRatio || 1;
    this.canvas.width = Math.round(dense * this.element.clientWidth);
    this.canvas.height = Math.round(dense * this.element.clientHeight);
    if (!this.isFitted) this.fit();
    this.draw();
  }

  private wheel(event: WheelEvent) {
    event.preventDefault();
    const box = this.canvas.getBoundingClientRect();
    this.zoom(Math.exp(-0.0015 * event.deltaY), { x: event.clientX - box.left, y: event.clientY - box.top });
  }

  /** The left button is the page's own, if it wants it; the others move the picture. */
  private down(event: PointerEvent) {
    this.canvas.focus();
    const isOwn = event.button === 0 && !event.shiftKey && this.pressed(this.at(event), event);
    this.canvas.setPointerCapture(event.pointerId);
    let last = { x: event.clientX, y: event.clientY };
    const move = (next: PointerEvent) => {
      if (isOwn) return;
      this.origin = { x: this.origin.x + next.clientX - last.x, y: this.origin.y + next.clientY - last.y };
      last = { x: next.clientX, y: next.clientY };
      this.draw();
    };
    const up = (next: PointerEvent) => {
      this.canvas.removeEventListener("pointermove", move);
      if (isOwn) this.released(this.at(next), next);
    };
    this.canvas.addEventListener("pointermove", move);
    this.canvas.addEventListener("pointerup", up, { once: true });
  }
}

/** A picture from the server. */
export async function picture(path: string): Promise<ImageBitmap> {
  const { load } = await import("pages/files");
  return createImageBitmap(await (await load(path)).blob());
}

/** Text in the fill's colour that is legible on anything. */
export function caption(context: CanvasRenderingContext2D, text: string, x: number, y: number, unit: number) {
  const { strokeStyle, lineWidth } = context;
  context.strokeStyle = "rgba(0,0,0,0.75)";
  context.lineWidth = 3 * unit;
  context.lineJoin = "round";
  context.strokeText(text, x, y);
  context.fillText(text, x, y);
  Object.assign(context, { strokeStyle, lineWidth });
}
