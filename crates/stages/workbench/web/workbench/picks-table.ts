// The table of picks as people write it: marker,x,y,z in the scan's unit, or marker,vertex. Rows that nobody touched stay as they are.
import { Vector3 } from "three";

export interface Pick {
  /** mm; of a vertex not known here. */
  at: Vector3;
  vertex: number | null;
  /** The row as it was read. */
  row: string | null;
}

export class PickTable {
  private readonly rows = new Map<string, Pick>();
  private head = "marker,x,y,z";
  form: "point" | "vertex" = "point";

  /** `unit`: mm per unit of the scan. */
  constructor(private readonly unit: number) {}

  static parse(text: string, unit: number): PickTable {
    const table = new PickTable(unit);
    for (const row of text.split(/\r?\n/).filter((row) => row.trim())) {
      const cells = row.split(/[,;\t]/).map((cell) => cell.trim());
      const numbers = cells.slice(1).map(Number);
      if (numbers.length === 0 || numbers.some((number) => !Number.isFinite(number))) {
        table.head = row;
        continue;
      }
      table.form = numbers.length === 1 ? "vertex" : "point";
      const at = new Vector3(...numbers).multiplyScalar(unit);
      table.rows.set(cells[0], { at, vertex: numbers.length === 1 ? numbers[0] : null, row });
    }
    if (table.form === "vertex" && table.head === "marker,x,y,z") table.head = "marker,vertex";
    return table;
  }

  print(): string {
    const digits = Math.max(0, Math.round(Math.log10(this.unit))) + 4;
    const row = ([marker, pick]: [string, Pick]) => {
      if (pick.row !== null) return pick.row;
      if (pick.vertex !== null) return `${marker},${pick.vertex}`;
      return [marker, ...pick.at.toArray().map((value) => `${Number((value / this.unit).toFixed(digits))}`)].join(",");
    };
    return `${[this.head, ...[...this.rows].map(row)].join("\n")}\n`;
  }

  markers(): string[] {
    return [...this.rows.keys()];
  }

  get(marker: string): Pick | undefined {
    return this.rows.get(marker);
  }

  set(marker: string, at: Vector3, vertex: number | null) {
    this.rows.set(marker, { at: at.clone(), vertex, row: null });
  }

  remove(marker: string) {
    this.rows.delete(marker);
  }
}

/** The name of a marker's partner on the other side: `_l` and `_r`, at the end or before a number. */
export function partner(marker: string): string | null {
  const found = marker.match(/^(.*_)([lrLR])((_?\d+)?)$/);
  if (!found) return null;
  const other: Record<string, string> = { l: "r", r: "l", L: "R", R: "L" };
  return `${found[1]}${other[found[2]]}${found[3]}`;
}

/** A pair is symmetric about a plane if its mirror image is this near, mm. */
const NEAR_MM = 4;

/** A plane by a point on it and its normal. */
type Plane = { middle: Vector3; normal: Vector3 };

const reflected = (at: Vector3, { middle, normal }: Plane) => at.clone().addScaledVector(normal, -2 * normal.dot(at.clone().sub(middle)));

/** The face's plane of symmetry: that of the pair with which most pairs agree, then the mean over these; x = 0 where there are too few. */
function symmetry(pairs: [Vector3, Vector3][]): Plane {
  const of = ([left, right]: [Vector3, Vector3]): Plane => ({ middle: left.clone().add(right).multiplyScalar(0.5), normal: left.clone().sub(right).normalize() });
  const agreeing = (plane: Plane) => pairs.filter(([left, right]) => reflected(left, plane).distanceTo(right) < NEAR_MM);
  const best = pairs.map((pair) => agreeing(of(pair))).sort((a, b) => b.length - a.length)[0] ?? [];
  if (best.length < 2) return { middle: new Vector3(), normal: new Vector3(1, 0, 0) };
  const sum = best.reduce((sum, [left, right]) => sum.add(left.clone().sub(right)), new Vector3());
  const middle = best.reduce((sum, [left, right]) => sum.add(left).add(right), new Vector3());
  return { normal: sum.normalize(), middle: middle.multiplyScalar(0.5 / best.length) };
}

/** Where a marker sits if the face is symmetric: the mirror image of its partner. */
export function mirrored(marker: string, known: Map<string, Vector3>): Vector3 | null {
  const other = known.get(partner(marker) ?? "");
  if (!other) return null;
  const pairs = [...known].flatMap(([name, at]): [Vector3, Vector3][] => {
    const opposite = /_[lL](_?\d+)?$/.test(name) ? known.get(partner(name) ?? "") : undefined;
    return opposite ? [[at, opposite]] : [];
  });
  return reflected(other, symmetry(pairs));
}
