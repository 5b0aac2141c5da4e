// The controls beside the picture.
import { choice, element, group, shortcuts, slider, themeButton, type Slider } from "pages/elements";
import type { Look } from "./character";
import type { About } from "./scene";

/** What the user chose. */
export interface State {
  /** Per pose how much of it. */
  poses: number[];
  wrinkles: boolean;
  look: Look;
  clip: number | null;
  frame: number;
  playing: boolean;
  /** Whence the light comes, degrees from the front to the character's left, and up. */
  aside: number;
  up: number;
  brightness: number;
}

/** What controls ask for. */
export interface Wishes {
  changed(): void;
  /** Goes to these poses, smoothly. */
  goTo(poses: number[]): void;
  resetView(): void;
  saveMap(): void;
}

export class Panel {
  private readonly poses: Slider[];
  private readonly time: Slider | null;
  private readonly timings = element("p", { class: "numbers", id: "timings" }, "–");
  private play: HTMLButtonElement | null = null;
  private readonly expressions: HTMLButtonElement[];

  constructor(
    root: HTMLElement,
    private readonly about: About,
    private readonly state: State,
    private readonly wishes: Wishes,
  ) {
    const { scene } = about;
    this.poses = scene.poses.map((pose, index) => this.poseSlider(pose.id, pose.color, index));
    this.expressions = scene.expressions.map(({ name, weights, lacks }, index) => {
      const title = lacks.length ? `Needs ${lacks.join(" and ")}, and no pose is named so` : `${scene.poses.map((pose, k) => (weights[k] ? `${pose.id} ${weights[k]}` : "")).filter(Boolean).join(", ")}${index < 9 ? ` (${index + 1})` : ""}`;
      const button = element("button", { type: "button", title, disabled: lacks.length > 0 }, name);
      button.addEventListener("click", () => wishes.goTo(weights));
      return button;
    });
    this.time = this.timeSlider();
    root.append(this.head(), this.showing(), this.expressionGroup(), group("Poses", element("div", { class: "poses" }, ...this.poses.map((one) => one.row))), ...this.motion(), this.light(), this.foot());
  }

  /** Shows what the state says now. */
  show() {
    this.poses.forEach((one, index) => one.show(this.state.poses[index]));
    this.time?.show(this.state.frame);
    if (this.play) this.play.textContent = this.state.playing ? "Pause" : "Play";
  }

  timing(text: string) {
    this.timings.textContent = text;
  }

  private changed<K extends keyof State>(key: K, value: State[K]) {
    this.state[key] = value;
    this.wishes.changed();
  }

  private poseSlider(id: string, color: number[], index: number): Slider {
    const swatch = element("span", { class: "swatch" });
    swatch.style.background = `rgb(${color.map((part) => Math.round(255 * part)).join(" ")})`;
    const name = element("span", { class: "name", title: id }, swatch, id);
    const range = { least: 0, most: 1, step: 0.01, value: 0, text: (value: number) => `${Math.round(100 * value)} %` };
    const made = slider(name, range, (value) => {
      this.state.poses[index] = value;
      this.wishes.changed();
    });
    made.input.id = `pose-${index}`;
    return made;
  }

  private head(): HTMLElement {
    const theme = themeButton(() => this.wishes.changed());
    const title = element("h1", { title: `${this.about.about.character}, mesh ${this.about.about.mesh}` }, this.about.about.character);
    shortcuts({ t: () => theme.click() });
    return element("div", { class: "head" }, title, theme);
  }

  private showing(): HTMLElement {
    const wrinkles = element("input", { type: "checkbox", id: "wrinkles", checked: this.state.wrinkles });
    wrinkles.addEventListener("change", () => this.changed("wrinkles", wrinkles.checked));
    const looks: [Look, string][] = [["skin", "Skin"], ["clay", "Clay"], ["influence", "Influence"]];
    const look = choice("look", looks, this.state.look, (value) => this.changed("look", value));
    const pick = (value: Look) => () => {
      look.show(value);
      this.changed("look", value);
    };
    shortcuts({ w: () => wrinkles.click(), s: pick("skin"), c: pick("clay"), i: pick("influence"), r: () => this.wishes.resetView() });
    const label = element("label", { class: "check", title: "Wrinkles on or off (W)" }, wrinkles, "Wrinkles");
    return group("Show", element("div", { class: "choice" }, label, look.set));
  }

  private expressionGroup(): HTMLElement {
    const { scene } = this.about;
    const neutral = element("button", { type: "button", title: "Neutral (0)" }, "neutral");
    neutral.addEventListener("click", () => this.wishes.goTo(scene.poses.map(() => 0)));
    shortcuts({ "0": () => neutral.click(), ...Object.fromEntries(this.expressions.slice(0, 9).map((button, index) => [`${index + 1}`, () => button.click()])) });
    const made = group("Expressions", element("div", { class: "buttons" }, neutral, ...this.expressions));
    const lacking = scene.expressions.filter((one) => one.lacks.length > 0);
    if (lacking.length) {
      const what = [...new Set(lacking.flatMap((one) => one.lacks))].join(", ");
      made.append(element("p", { class: "note" }, `No pose is named for ${what}. Give expressions with --expression NAME=POSE:SHARE.`));
    }
    return made;
  }

  private timeSlider(): Slider | null {
    const { clips } = this.about.scene;
    if (!clips.length) return null;
    const clip = () => clips[this.state.clip ?? 0];
    const text = (value: number) => `${(value / clip().hz).toFixed(2)} s`;
    const made = slider("Time", { least: 0, most: 1, step: 0.1, value: 0, text }, (value) => {
      this.state.playing = false;
      this.changed("frame", value);
      this.show();
    });
    made.input.id = "time";
    made.input.disabled = true;
    return made;
  }

  private motion(): HTMLElement[] {
    const { clips } = this.about.scene;
    const time = this.time;
    if (!time) return [];
    const list = element("select", { id: "clip" }, element("option", { value: "" }, "None: sliders only"), ...clips.map((clip, index) => element("option", { value: `${index}` }, clip.name)));
    list.setAttribute("aria-label", "Animation");
    const play = element("button", { type: "button", title: "Play or pause (space)", disabled: true }, "Play");
    list.addEventListener("change", () => {
      const chosen = list.value === "" ? null : Number(list.value);
      Object.assign(this.state, { clip: chosen, frame: 0, playing: chosen !== null });
      time.input.disabled = play.disabled = chosen === null;
      if (chosen !== null) time.input.max = `${clips[chosen].frames - 1}`;
      this.wishes.changed();
      this.show();
    });
    play.addEventListener("click", () => {
      this.changed("playing", !this.state.playing);
      this.show();
    });
    shortcuts({ " ": () => play.click() });
    this.play = play;
    return [group("Animation", element("div", { class: "motion" }, list, play), time.row)];
  }

  private light(): HTMLElement {
    const degrees = (value: number) => `${value.toFixed(0)}°`;
    const aside = slider("From the side", { least: -180, most: 180, step: 1, value: this.state.aside, text: degrees }, (value) => this.changed("aside", value));
    const up = slider("From above", { least: -80, most: 85, step: 1, value: this.state.up, text: degrees }, (value) => this.changed("up", value));
    const strength = slider("Strength", { least: 0, most: 2, step: 0.05, value: this.state.brightness, text: (value) => value.toFixed(2) }, (value) => this.changed("brightness", value));
    aside.input.id = "aside";
    return group("Light", aside.row, up.row, strength.row);
  }

  private foot(): HTMLElement {
    const save = element("button", { type: "button", title: "The normal map as the shader has it now" }, "Save blended map");
    save.addEventListener("click", () => this.wishes.saveMap());
    const reset = element("button", { type: "button", title: "Look from the front (R)" }, "Reset view");
    reset.addEventListener("click", () => this.wishes.resetView());
    const keys = element("p", {}, element("kbd", {}, "W"), " wrinkles ", element("kbd", {}, "0"), "–", element("kbd", {}, "6"), " expressions ", element("kbd", {}, "S"), " ", element("kbd", {}, "C"), " ", element("kbd", {}, "I"), " look ", element("kbd", {}, "R"), " view");
    return element("footer", {}, element("div", { class: "choice" }, save, reset), this.timings, keys);
  }
}
