// Names over places in three dimensions, drawn on a canvas of their own above the view.
import type { View } from "pages/view";
import type { Vector3 } from "three";
import { caption } from "./sheet";

export interface Place3d {
  name: string;
  at: Vector3;
  look: string;
}

const COLORS: Record<string, string> = { chosen: "#ffffff", bad: "#ff8a5c", guess: "#ffd34d" };

export class Labels3d {
  private readonly canvas = document.createElement("canvas");
  private places: Place3d[] = [];

  constructor(
    parent: HTMLElement,
    private readonly view: View,
  ) {
    this.canvas.style.pointerEvents = "none";
    parent.append(this.canvas);
    view.after = () => this.draw();
  }

  show(places: Place3d[]) {
    this.places = places;
    this.view.draw();
  }

  private draw() {
    const dense = devicePixelRatio || 1;
    const { clientWidth: width, clientHeight: height } = this.canvas;
    if (this.canvas.width !== Math.round(dense * width)) this.canvas.width = Math.round(dense * width);
    if (this.canvas.height !== Math.round(dense * height)) this.canvas.height = Math.round(dense * height);
    const context = this.canvas.getContext("2d");
    if (!context) return;
    context.setTransform(dense, 0, 0, dense, 0, 0);
    context.clearRect(0, 0, width, height);
    context.font = "11px system-ui, sans-serif";
    for (const { name, at, look } of this.places) {
      const seen = at.clone().project(this.view.camera);
      if (seen.z > 1) continue;
      const [x, y] = [(0.5 + 0.5 * seen.x) * width, (0.5 - 0.5 * seen.y) * height];
      context.strokeStyle = context.fillStyle = COLORS[look] ?? "#2f7bff";
      context.lineWidth = look === "chosen" ? 3 : 2;
      context.beginPath();
      context.arc(x, y, 4.5, 0, 2 * Math.PI);
      context.stroke();
      if (look) caption(context, name, x + 8, y + 4, 1);
    }
  }
}
