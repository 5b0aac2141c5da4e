// How far each bone went towards each pose: as `Blender::shares` has it; a test compares them.
import { Vector3 } from "three";
import type { Rig } from "./rig";
import type { SceneDocument } from "./scene";

/** Price of the way, as a share of the move, and what keeps the problem convex: as in `dual.rs`. */
const PRICE = 1e-3;
const RIDGE = 1e-7;

export class Shares {
  private readonly ways: { pose: number; way: Vector3 }[][];
  private readonly neutral: Vector3[];
  private readonly probes: Vector3[];
  /** α: per pose one per bone. */
  readonly alpha: Float64Array[];
  /** θ(α): per bone four numbers per group of four poses, as the shader takes them. */
  readonly table: Float32Array;
  readonly groups: number;

  constructor(private readonly scene: SceneDocument) {
    const vector = (list: [number, number, number]) => new Vector3(...list);
    this.ways = scene.bones.map((_, bone) =>
      scene.poses.flatMap(({ ways }, pose) => {
        const way = ways[bone];
        return way ? [{ pose, way: vector(way) }] : [];
      }),
    );
    this.neutral = scene.bones.map((bone) => vector(bone.neutral));
    this.probes = scene.bones.map((bone) => vector(bone.probe));
    this.alpha = scene.poses.map(() => new Float64Array(scene.bones.length));
    this.groups = Math.ceil(scene.poses.length / 4);
    this.table = new Float32Array(4 * this.groups * scene.bones.length);
  }

  update(rig: Rig) {
    this.scene.bones.forEach(({ node }, bone) => {
      const place = this.probes[bone].clone();
      const headFromBone = rig.headFromNode[node];
      if (headFromBone) place.applyMatrix4(headFromBone);
      const ab = place.multiplyScalar(this.scene.mm_per_unit).sub(this.neutral[bone]);
      const of = this.ways[bone];
      const found = this.scene.dual
        ? sharedOut(of.map((one) => one.way), ab)
        : of.map(({ way }) => ab.dot(way) / way.lengthSq());
      of.forEach(({ pose }, index) => {
        const alpha = Math.max(0, Math.min(1, found[index]));
        this.alpha[pose][bone] = alpha;
        this.table[4 * this.groups * bone + pose] = this.modulated(alpha);
      });
    });
  }

  /** θ. */
  private modulated(x: number): number {
    const points = this.scene.modulation;
    if (!points) return 0.5 * (Math.cos(Math.PI * (1 + x)) + 1);
    const behind = points.findIndex((point) => point[0] >= x);
    const after = Math.max(1, behind < 0 ? points.length - 1 : behind);
    const [[x0, y0], [x1, y1]] = [points[after - 1], points[after]];
    return Math.max(0, Math.min(1, y0 + ((x - x0) / (x1 - x0)) * (y1 - y0)));
  }
}

/** α ≥ 0 of the shortest way that minimises ‖AB − Σ α_k AC_k‖: `dual.rs`. */
function sharedOut(ways: Vector3[], b: Vector3): number[] {
  const length = b.length();
  if (length === 0) return ways.map(() => 0);
  const units = ways.map((way) => way.clone().divideScalar(way.length()));
  const goal = b.clone().divideScalar(length);
  const priced = activeSet(units, goal);
  const parts = unpriced(units, goal, priced) ?? priced;
  return parts.map((part, k) => (part * length) / ways[k].length());
}

function activeSet(units: Vector3[], b: Vector3): number[] {
  const x = units.map(() => 0);
  let chosen: number[] = [];
  for (let round = 0; round < 3 * units.length; round++) {
    const rest = b.clone();
    units.forEach((unit, k) => rest.addScaledVector(unit, -x[k]));
    let best = -1;
    let most = 1e-12;
    units.forEach((unit, k) => {
      const gain = unit.dot(rest) - PRICE - RIDGE * x[k];
      if (!chosen.includes(k) && gain > most) [best, most] = [k, gain];
    });
    if (best < 0) break;
    chosen.push(best);
    for (;;) {
      const goal = solved(units, b, PRICE, RIDGE, chosen);
      if (!goal) break;
      if (goal.every((part) => part > 0)) {
        chosen.forEach((k, index) => (x[k] = goal[index]));
        break;
      }
      let step = 1;
      chosen.forEach((k, index) => {
        if (goal[index] <= 0) step = Math.min(step, x[k] / (x[k] - goal[index]));
      });
      chosen.forEach((k, index) => (x[k] += step * (goal[index] - x[k])));
      chosen = chosen.filter((k) => x[k] > 1e-14);
      x.forEach((_, k) => {
        if (!chosen.includes(k)) x[k] = 0;
      });
    }
  }
  return x;
}

function unpriced(units: Vector3[], b: Vector3, found: number[]): number[] | null {
  const chosen = found.flatMap((part, k) => (part > 0 ? [k] : []));
  if (chosen.length === 0 || chosen.length > 3) return null;
  const parts = solved(units, b, 0, 0, chosen);
  if (!parts) return null;
  const isSane = parts.every((part, index) => Math.abs(part - found[chosen[index]]) <= 10 * PRICE && part >= 0);
  if (!isSane) return null;
  const x = found.map(() => 0);
  chosen.forEach((k, index) => (x[k] = parts[index]));
  return x;
}

/** The unconstrained minimum over the chosen, by Cholesky; none if they depend on each other. */
function solved(units: Vector3[], b: Vector3, price: number, ridge: number, chosen: number[]): number[] | null {
  const n = chosen.length;
  const l = chosen.map(() => new Array<number>(n).fill(0));
  for (let i = 0; i < n; i++) {
    for (let j = 0; j <= i; j++) {
      let sum = units[chosen[i]].dot(units[chosen[j]]) + (i === j ? ridge : 0);
      for (let k = 0; k < j; k++) sum -= l[i][k] * l[j][k];
      if (i === j && sum <= 0) return null;
      l[i][j] = i === j ? Math.sqrt(sum) : sum / l[j][j];
    }
  }
  const x = chosen.map((k) => units[k].dot(b) - price);
  for (let i = 0; i < n; i++) {
    for (let k = 0; k < i; k++) x[i] -= l[i][k] * x[k];
    x[i] /= l[i][i];
  }
  for (let i = n - 1; i >= 0; i--) {
    for (let k = i + 1; k < n; k++) x[i] -= l[k][i] * x[k];
    x[i] /= l[i][i];
  }
  return x;
}
