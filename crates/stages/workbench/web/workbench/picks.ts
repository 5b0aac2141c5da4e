// Where each marker sits on the scan.
import { element, group } from "pages/elements";
import { View } from "pages/view";
import { Mesh, MeshStandardMaterial, Raycaster, Vector2, Vector3, type BufferGeometry, type Intersection } from "three";
import type { Desk, Tool } from "./desk";
import { Held } from "./held";
import { Labels3d } from "./labels-3d";
import { lights, loadMesh } from "./mesh";
import { PickTable, mirrored } from "./picks-table";
import { ask, json } from "./server";
import { Waiting } from "./waiting";

/** What `rbf-warp` says of the picks. */
interface Fit {
  similarity_rms_mm: number;
  leave_one_out_mm: Record<string, number>;
  left_out: Record<string, string>;
}

/** A leave-one-out error this many times the median, and above so many mm, is doubtful: as in `rbf-warp`. */
const TIMES = 4;
const FLOOR_MM = 2;
const UNITS: Record<string, number> = { mm: 1, cm: 10, m: 1000 };

export async function picks(desk: Desk): Promise<Tool> {
  const unit = UNITS[desk.overview.manifest?.mesh_unit ?? "mm"];
  const held = new Held<PickTable>("picks", desk.session, () => new PickTable(unit), (text) => PickTable.parse(text, unit), (table) => table.print());
  const page = new PicksPage(desk, held);
  await page.start();
  return { element: page.element, held, keys: page.keys, close: () => page.close(), get busy() { return page.busy; } };
}

class PicksPage {
  readonly element = element("div", { class: "desk" });
  private readonly canvas = element("canvas", { tabIndex: 0 });
  private readonly view: View;
  private readonly names3d: Labels3d;
  private readonly list = element("ul", { class: "list" });
  private readonly count = element("p", { id: "count", class: "note" });
  private readonly fitNote = element("p", { id: "warp", class: "note" });
  private readonly nameInput = element("input", { placeholder: "marker", spellcheck: false, title: "Type a name to choose it, or to add it" });
  private readonly material = new MeshStandardMaterial({ color: 0xd8b8a6, roughness: 0.75 });
  private full: Mesh | null = null;
  private coarse: Mesh | null = null;
  private names: string[] = [];
  private marker = "";
  private fit: Fit | null = null;
  private fitTimer = 0;
  private readonly waiting = new Waiting();

  get busy(): boolean {
    return this.fitTimer !== 0 || this.waiting.busy;
  }

  readonly keys: Record<string, () => void>;

  constructor(
    private readonly desk: Desk,
    private readonly held: Held<PickTable>,
  ) {
    this.canvas.setAttribute("aria-label", "The scan: click to say where the chosen marker sits, drag or use the arrow keys to turn it");
    const sheet = element("div", { class: "sheet" }, this.canvas);
    this.element.append(sheet, this.panel());
    this.view = new View(this.canvas);
    this.names3d = new Labels3d(sheet, this.view);
    this.keys = { n: () => this.choose(1), p: () => this.choose(-1), Delete: () => this.clear(), f: () => this.view.reset(), m: () => this.mirror() };
    this.canvas.addEventListener("pointerdown", (event) => this.press(event));
  }

  async start() {
    await this.held.load();
    this.held.changed = (said) => {
      this.desk.say(said);
      this.show();
    };
    this.names = await labelNames();
    this.view.scene.add(...lights(this.view.camera));
    this.view.scene.add(this.view.camera);
    this.coarse = new Mesh(await loadMesh("mesh/scan-coarse"), this.material);
    this.view.scene.add(this.coarse);
    this.coarse.geometry.computeBoundingSphere();
    const ball = this.coarse.geometry.boundingSphere;
    if (ball) this.view.frame(ball.center, ball.radius);
    this.show();
    void loadMesh("mesh/scan").then((geometry) => this.complete(geometry)).catch((error: Error) => this.desk.fail(error.message));
  }

  close() {
    clearTimeout(this.fitTimer);
    this.full?.geometry.dispose();
    this.coarse?.geometry.dispose();
    this.view.renderer.dispose();
  }

  /** The whole scan is there: the coarse one shows only while it turns. */
  private complete(geometry: BufferGeometry) {
    this.full = new Mesh(geometry, this.material);
    this.view.scene.add(this.full);
    this.turning(false);
    let rest = 0;
    const isBusy = () => {
      this.turning(true);
      clearTimeout(rest);
      rest = window.setTimeout(() => this.turning(false), 250);
    };
    this.canvas.addEventListener("pointermove", (event) => event.buttons && isBusy());
    this.canvas.addEventListener("wheel", isBusy);
    this.canvas.addEventListener("keydown", (event) => event.key.startsWith("Arrow") && isBusy());
    this.canvas.dataset.complete = "yes";
    this.show();
  }

  private turning(is: boolean) {
    if (!this.full || !this.coarse) return;
    this.full.visible = !is;
    this.coarse.visible = is;
    this.view.draw();
  }

  /** A press without a drag is a pick. */
  private press(down: PointerEvent) {
    if (down.button !== 0) return;
    const up = (event: PointerEvent) => {
      if (Math.hypot(event.clientX - down.clientX, event.clientY - down.clientY) < 4) this.pick(event);
    };
    this.canvas.addEventListener("pointerup", up, { once: true });
  }

  private meets(x: number, y: number): Intersection | null {
    const box = this.canvas.getBoundingClientRect();
    const place = new Vector2((2 * (x - box.left)) / box.width - 1, 1 - (2 * (y - box.top)) / box.height);
    const ray = new Raycaster();
    ray.setFromCamera(place, this.view.camera);
    return this.full ? (ray.intersectObject(this.full)[0] ?? null) : null;
  }

  private pick(event: PointerEvent) {
    if (!this.desk.session.holds) return;
    const hit = this.meets(event.clientX, event.clientY);
    if (!hit?.face) return;
    if (!this.marker) {
      this.desk.say("Choose a marker in the list, or type a new name first.");
      return;
    }
    const { a, b, c } = hit.face;
    const place = this.held.value.form === "vertex" ? this.nearestCorner([a, b, c], hit.point) : null;
    this.held.change((table) => table.set(this.marker, hit.point, place));
    this.nextFree();
  }

  private nearestCorner(corners: number[], at: Vector3): number {
    const far = (vertex: number) => this.vertex(vertex).distanceTo(at);
    return corners.reduce((best, vertex) => (far(vertex) < far(best) ? vertex : best));
  }

  private vertex(index: number): Vector3 {
    const positions = this.full?.geometry.getAttribute("position");
    return positions ? new Vector3().fromBufferAttribute(positions, index) : new Vector3();
  }

  /** Where a marker is picked, mm. */
  private at(marker: string): Vector3 | null {
    const pick = this.held.value.get(marker);
    if (!pick) return null;
    return pick.vertex === null ? pick.at : this.full ? this.vertex(pick.vertex) : null;
  }

  private markers(): string[] {
    return [...new Set([...this.names, ...this.held.value.markers()])].sort();
  }

  private clear() {
    this.held.change((table) => table.remove(this.marker));
  }

  private choose(step: number) {
    const all = this.markers();
    this.marker = all[(all.indexOf(this.marker) + step + all.length) % all.length] ?? "";
    this.show();
  }

  private nextFree() {
    const all = this.markers();
    const start = all.indexOf(this.marker);
    const order = [...all.slice(start + 1), ...all.slice(0, start + 1)];
    this.marker = order.find((marker) => !this.held.value.get(marker)) ?? this.marker;
    this.show();
  }

  /** Where a marker may sit because its partner of the other side is picked: the mirrored place, on the scan. */
  private guess(marker: string): Vector3 | null {
    const known = new Map(this.held.value.markers().flatMap((name) => {
      const at = this.at(name);
      return at ? [[name, at] as const] : [];
    }));
    const guess = mirrored(marker, known);
    if (!guess || !this.full) return null;
    // From outside towards the middle of the head.
    const middle = this.full.geometry.boundingSphere?.center ?? new Vector3();
    const outwards = guess.clone().sub(middle).normalize();
    const ray = new Raycaster(guess.clone().addScaledVector(outwards, 30), outwards.clone().negate(), 0, 60);
    return ray.intersectObject(this.full)[0]?.point ?? null;
  }

  private mirror() {
    const guess = this.guess(this.marker);
    if (!guess) {
      this.desk.say("There is nothing to mirror: the marker's name must end in _l or _r (with a number, maybe), and its partner be picked.");
      return;
    }
    this.held.change((table) => table.set(this.marker, guess, null));
    this.nextFree();
  }

  private panel(): HTMLElement {
    this.nameInput.addEventListener("keydown", (event) => {
      const name = this.nameInput.value.trim();
      if (event.key !== "Enter" || !name) return;
      if (!this.markers().includes(name)) this.names.push(name);
      this.marker = name;
      this.nameInput.value = "";
      this.show();
    });
    const button = (text: string, title: string, action: () => void) => {
      const made = element("button", { type: "button", title }, text);
      made.addEventListener("click", action);
      return made;
    };
    const keys: [string, string][] = [["Click", "the marker sits here"], ["N P", "next, previous marker"], ["Del", "take the pick away"], ["M", "the mirrored place"], ["F", "front view"], ["Ctrl Z Y S", "undo, redo, save"]];
    return element("aside", { class: "panel" },
      group("Markers", this.list, this.count,
        element("div", { class: "row" }, element("span", { class: "grow" }, this.nameInput), button("Mirror", "Where its partner of the other side is (M)", () => this.mirror()), button("Clear", "Take this pick away (Delete)", () => this.clear()))),
      group("Warp", this.fitNote),
      element("div", { class: "keys" }, ...keys.flatMap(([key, what]) => [element("kbd", {}, key), element("span", {}, what)])));
  }

  private show() {
    const all = this.markers();
    if (!all.includes(this.marker)) this.marker = all.find((marker) => !this.held.value.get(marker)) ?? all[0] ?? "";
    this.showList();
    const places = this.held.value.markers().flatMap((marker) => {
      const at = this.at(marker);
      return at ? [{ name: marker, at, look: marker === this.marker ? "chosen" : this.isDoubtful(marker) ? "bad" : "" }] : [];
    });
    const guess = this.held.value.get(this.marker) ? null : this.guess(this.marker);
    this.names3d.show(guess ? [...places, { name: `${this.marker}?`, at: guess, look: "guess" }] : places);
    clearTimeout(this.fitTimer);
    this.fitTimer = window.setTimeout(() => {
      this.fitTimer = 0;
      void this.waiting.for(() => this.warp());
    }, 500);
  }

  private isDoubtful(marker: string): boolean {
    const errors = Object.values(this.fit?.leave_one_out_mm ?? {}).sort((a, b) => a - b);
    const off = this.fit?.leave_one_out_mm[marker] ?? 0;
    return off > FLOOR_MM && off > TIMES * (errors[errors.length >> 1] ?? 0);
  }

  private showList() {
    const rows = this.markers().map((marker) => {
      const off = this.fit?.leave_one_out_mm[marker];
      const shown = off === undefined ? "" : `${off.toFixed(1)} mm`;
      const row = element("li", {}, element("span", { class: "name" }, marker), element("span", {}, this.held.value.get(marker) ? "●" : ""),
        element("span", { class: `numbers ${this.isDoubtful(marker) ? "bad" : "quiet"}`, title: "How far off the warp of all others puts it" }, shown));
      row.setAttribute("aria-selected", `${marker === this.marker}`);
      row.addEventListener("click", () => {
        this.marker = marker;
        this.show();
      });
      return row;
    });
    this.list.replaceChildren(...rows);
    this.list.querySelector('[aria-selected="true"]')?.scrollIntoView({ block: "nearest" });
    const lacking = this.markers().filter((marker) => !this.held.value.get(marker));
    this.count.textContent = `${this.held.value.markers().length} picked · ${lacking.length} not yet`;
  }

  /** Asks what the warp makes of the picks. */
  private async warp() {
    if (this.held.value.markers().length < 4) {
      this.fitNote.textContent = "From four markers on, the warp says here how far off each one is.";
      return;
    }
    const found = await ask<{ fit: Fit } | { lacks: string }>("warp", { picks: this.held.value.print() }).catch((error: Error) => ({ lacks: error.message }));
    this.fit = "fit" in found ? found.fit : null;
    const errors = Object.values(this.fit?.leave_one_out_mm ?? {}).sort((a, b) => a - b);
    this.fitNote.textContent = "lacks" in found ? found.lacks
      : `Each marker left out in turn is put ${errors[errors.length >> 1]?.toFixed(2) ?? "?"} mm off (median); the face fits the markers to ${found.fit.similarity_rms_mm.toFixed(1)} mm without the warp.`;
    this.showList();
  }
}

/** Names of the labelled markers. */
async function labelNames(): Promise<string[]> {
  const shown = await json<{ saved: string | null }>("document/labels").catch(() => ({ saved: null }));
  const cameras: Record<string, object> = shown.saved ? JSON.parse(shown.saved).data.cameras : {};
  return [...new Set(Object.values(cameras).flatMap((dots) => Object.keys(dots)))];
}
