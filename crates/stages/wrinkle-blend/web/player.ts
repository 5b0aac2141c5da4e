// The player: a character with its wrinkles, moved by hand or by its animations.
import { MathUtils, Vector3 } from "three";
import { View } from "pages/view";
import { Character, loadColors, loadMaps, tooMuch } from "./player/character";
import { Panel, type State } from "./player/panel";
import { Rig } from "./player/rig";
import { loadScene } from "./player/scene";
import { Shares } from "./player/shares";

/** How long an expression takes to come, s; none for who wants no motion. */
const COMING = matchMedia("(prefers-reduced-motion: reduce)").matches ? 0 : 0.35;

const byId = <T extends HTMLElement>(id: string) => document.getElementById(id) as T;

function notice(text: string, failed = false) {
  const at = byId("notice");
  at.textContent = text;
  at.hidden = !text;
  at.classList.toggle("failed", failed);
}

/** Where the lamp stands, as a direction. */
function lamp({ aside, up }: State): Vector3 {
  const [a, b] = [MathUtils.degToRad(aside), MathUtils.degToRad(up)];
  return new Vector3(Math.cos(b) * Math.sin(a), Math.sin(b), Math.cos(b) * Math.cos(a));
}

/** The way from poses to poses. */
class Coming {
  private from: number[] = [];
  private to: number[] | null = null;
  private share = 1;

  start(from: number[], to: number[]) {
    [this.from, this.to, this.share] = [[...from], to, 0];
  }

  stop() {
    this.to = null;
  }

  /** Goes on; whether it is still on its way. */
  step(seconds: number, poses: number[]): boolean {
    if (!this.to) return false;
    this.share = COMING ? Math.min(1, this.share + seconds / COMING) : 1;
    const eased = this.share * this.share * (3 - 2 * this.share);
    this.to.forEach((goal, k) => (poses[k] = this.from[k] + eased * (goal - this.from[k])));
    if (this.share >= 1) this.to = null;
    return true;
  }
}

/** The median of the latest frames. */
class Times {
  private readonly list: number[] = [];

  add(time: number) {
    this.list.push(time);
    if (this.list.length > 60) this.list.shift();
  }

  median(): string {
    return [...this.list].sort((a, b) => a - b)[this.list.length >> 1]?.toFixed(1) ?? "–";
  }
}

function save({ width, height, data }: { width: number; height: number; data: Uint8Array }) {
  const canvas = new OffscreenCanvas(width, height);
  const opaque = new Uint8ClampedArray(data);
  for (let at = 0; at < opaque.length; at += 4) {
    // Flat where no triangle lies.
    if (opaque[at + 3] === 0) opaque.set([128, 128, 255], at);
    opaque[at + 3] = 255;
  }
  canvas.getContext("2d")?.putImageData(new ImageData(opaque, width, height), 0, 0);
  void canvas.convertToBlob({ type: "image/png" }).then((blob) => {
    const link = document.createElement("a");
    link.href = URL.createObjectURL(blob);
    link.download = "blended.png";
    link.click();
    setTimeout(() => URL.revokeObjectURL(link.href), 10_000);
  });
}

async function start() {
  notice("Loading …");
  const { about, block, equations } = await loadScene();
  const { scene } = about;
  document.title = `${about.about.character} · wrinkle-blend`;
  const view = new View(byId<HTMLCanvasElement>("view"));
  const lacking = tooMuch(scene, view.renderer);
  if (lacking) throw new Error(lacking);
  const [maps, colors] = await Promise.all([loadMaps(scene, about.map_size, view.renderer), about.color ? loadColors(view.renderer) : null]);
  const [rig, shares, coming] = [new Rig(scene, block), new Shares(scene), new Coming()];
  const character = new Character(about, block, equations, maps, colors, shares);
  const state: State = {
    poses: scene.poses.map(() => 0), wrinkles: true, look: "skin", clip: null, frame: 0, playing: false, aside: 38, up: 34, brightness: 1,
  };

  const follow = () => {
    rig.rest();
    if (state.clip !== null) rig.play(scene.clips[state.clip], state.frame);
    state.poses.forEach((share, pose) => rig.add(pose, share));
    rig.update();
    character.update(rig);
    const { common } = character;
    common.shown.value = state.wrinkles ? 1 : 0;
    common.lamp.value.copy(lamp(state));
    common.brightness.value = state.brightness;
    character.look = state.look;
  };

  const panel = new Panel(byId("panel"), about, state, {
    changed: () => {
      coming.stop();
      view.draw();
    },
    goTo: (poses) => {
      coming.start(state.poses, poses);
      view.draw();
    },
    resetView: () => view.reset(),
    saveMap: () => save(character.blended(view.renderer)),
  });

  view.before = (seconds) => {
    const comes = coming.step(seconds, state.poses);
    if (state.playing && state.clip !== null) {
      const { frames, hz } = scene.clips[state.clip];
      state.frame = frames > 1 ? (state.frame + seconds * hz) % (frames - 1) : 0;
    }
    if (comes || state.playing) panel.show();
    follow();
    return comes || state.playing;
  };
  const [intervals, works] = [new Times(), new Times()];
  let shownAt = 0;
  view.after = (interval, work) => {
    works.add(work);
    // Pauses are no frames.
    if (interval < 500) intervals.add(interval);
    if (performance.now() - shownAt < 300) return;
    shownAt = performance.now();
    const { triangles } = view.renderer.info.render;
    panel.timing(`${intervals.median()} ms a frame, ${works.median()} ms of it for this page · ${triangles} triangles`);
  };

  follow();
  const ball = character.bounds();
  view.frame(ball.center, ball.radius);
  character.addTo(view.scene);
  view.draw();
  notice("");

  // For tests and for the curious, in the console.
  Object.assign(globalThis, {
    player: {
      scene,
      /** Sets poses, and a frame of a clip if one is named; at once. */
      set(poses: number[], clip: string | null = null, frame = 0) {
        const index = scene.clips.findIndex((one) => one.name === clip);
        Object.assign(state, { poses: [...poses], clip: index < 0 ? null : index, frame, playing: false });
        coming.stop();
        follow();
        panel.show();
        view.draw();
      },
      /** α per pose and bone. */
      shares: () => shares.alpha.map((of) => [...of]),
      blended: () => character.blended(view.renderer),
      state,
      view,
    },
  });
  document.body.dataset.ready = "";
}

start().catch((error: unknown) => {
  notice(`The character cannot be shown: ${error instanceof Error ? error.message : String(error)}`, true);
  document.body.dataset.failed = "";
});
