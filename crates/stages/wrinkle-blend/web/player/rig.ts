// Where the bones stand: neutral, plus what poses add, on top of a clip if one plays.
import { Matrix4, Quaternion, Vector3 } from "three";
import type { Block, Clip, SceneDocument } from "./scene";

/** Numbers of a placement: translation, rotation x y z w, scale. */
const STRIDE = 10;
const NONE = new Quaternion();

const turn = (list: ArrayLike<number>, at: number) => new Quaternion(list[at + 3], list[at + 4], list[at + 5], list[at + 6]);

export class Rig {
  private readonly neutral: Float32Array;
  private readonly poses: Float32Array[];
  private readonly order: number[];
  private readonly placements: Float64Array;
  /** Per node its place in the file's space. */
  readonly worldFromNode: Matrix4[];
  /** Per node its place in the head's space; none above and beside the head. */
  readonly headFromNode: (Matrix4 | null)[];

  constructor(
    private readonly scene: SceneDocument,
    private readonly block: Block,
  ) {
    this.neutral = block.floats(scene.neutral);
    this.poses = scene.poses.map((pose) => block.floats(pose.placements));
    this.order = downwards(scene);
    this.placements = new Float64Array(this.neutral);
    this.worldFromNode = scene.nodes.map(() => new Matrix4());
    this.headFromNode = scene.nodes.map(() => null);
    this.update();
  }

  /** Back to the neutral pose. */
  rest() {
    this.placements.set(this.neutral);
  }

  /** The pose of a clip at a frame, which may lie between two. */
  play(clip: Clip, frame: number) {
    const keys = this.block.floats(clip.placements);
    const last = clip.frames - 1;
    const at = Math.max(0, Math.min(last, frame));
    const before = Math.min(Math.floor(at), last);
    const share = at - before;
    clip.nodes.forEach((node, index) => {
      const a = STRIDE * (before * clip.nodes.length + index);
      const b = STRIDE * (Math.min(before + 1, last) * clip.nodes.length + index);
      for (const part of [0, 1, 2, 7, 8, 9]) {
        this.placements[STRIDE * node + part] = keys[a + part] + share * (keys[b + part] - keys[a + part]);
      }
      this.setTurn(node, share === 0 ? turn(keys, a) : turn(keys, a).slerp(turn(keys, b), share));
    });
  }

  /** Adds a share of what a reference pose adds to rest. */
  add(pose: number, share: number) {
    if (share === 0) return;
    const goal = this.poses[pose];
    for (let node = 0; node < this.scene.nodes.length; node++) {
      const at = STRIDE * node;
      for (let axis = 0; axis < 3; axis++) {
        this.placements[at + axis] += share * (goal[at + axis] - this.neutral[at + axis]);
        this.placements[at + 7 + axis] *= 1 + share * (goal[at + 7 + axis] / this.neutral[at + 7 + axis] - 1);
      }
      const way = turn(this.neutral, at).invert().multiply(turn(goal, at));
      this.setTurn(node, turn(this.placements, at).multiply(NONE.clone().slerp(way, share)));
    }
  }

  /** Brings the matrices up to date. */
  update() {
    const local = new Matrix4();
    for (const node of this.order) {
      const at = STRIDE * node;
      const p = this.placements;
      local.compose(new Vector3(p[at], p[at + 1], p[at + 2]), turn(p, at), new Vector3(p[at + 7], p[at + 8], p[at + 9]));
      const parent = this.scene.nodes[node].parent;
      if (parent === null) this.worldFromNode[node].copy(local);
      else this.worldFromNode[node].multiplyMatrices(this.worldFromNode[parent], local);
      const above = parent === null ? null : this.headFromNode[parent];
      if (node === this.scene.head) this.headFromNode[node] = new Matrix4();
      else this.headFromNode[node] = above && new Matrix4().multiplyMatrices(above, local);
    }
  }

  private setTurn(node: number, q: Quaternion) {
    this.placements.set([q.x, q.y, q.z, q.w], STRIDE * node + 3);
  }
}

/** Nodes, each behind its parent. */
function downwards(scene: SceneDocument): number[] {
  const depth = (node: number): number => {
    const parent = scene.nodes[node].parent;
    return parent === null ? 0 : 1 + depth(parent);
  };
  const depths = scene.nodes.map((_, node) => depth(node));
  return scene.nodes.map((_, node) => node).sort((a, b) => depths[a] - depths[b] || a - b);
}
