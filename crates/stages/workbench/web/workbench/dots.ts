// Dots of an image, and names carried over from another camera.

export type Point = [number, number];
/** Places by marker. */
export type Named = Record<string, Point>;

export interface Dot {
  at: Point;
  /** px² */
  area: number;
}

/** The dots in a table of `marker-track detect`. */
export function dotsOf(table: string): Dot[] {
  const [head, ...rows] = table.trim().split(/\r?\n/).map((row) => row.split(","));
  const [x, y, area] = ["x", "y", "area"].map((name) => head.indexOf(name));
  return rows.map((row) => ({ at: [Number(row[x]), Number(row[y])], area: Number(row[area]) }));
}

export const distance = (a: Point, b: Point) => Math.hypot(a[0] - b[0], a[1] - b[1]);

/** The dot nearest to a place, within a reach. */
export function nearest(dots: Dot[], at: Point, reach: number): Dot | null {
  let [best, least] = [null as Dot | null, reach];
  for (const dot of dots) {
    const far = distance(dot.at, at);
    if (far <= least) [best, least] = [dot, far];
  }
  return best;
}

/** An affine map by least squares; nearer pairs count more. Null from fewer than three, or from pairs on a line. */
function affine(pairs: [Point, Point][], about: Point, reach: number): ((point: Point) => Point) | null {
  if (pairs.length < 3) return null;
  // Normal equations of x' = a + b (x - x0) + c (y - y0), the same for y'.
  const normal = [[0, 0, 0], [0, 0, 0], [0, 0, 0]];
  const right = [[0, 0], [0, 0], [0, 0]];
  for (const [from, to] of pairs) {
    const row = [1, from[0] - about[0], from[1] - about[1]];
    const weight = 1 / (1 + (Math.hypot(row[1], row[2]) / reach) ** 4);
    for (let i = 0; i < 3; i++) {
      for (let j = 0; j < 3; j++) normal[i][j] += weight * row[i] * row[j];
      for (let j = 0; j < 2; j++) right[i][j] += weight * row[i] * to[j];
    }
  }
  for (let i = 0; i < 3; i++) {
    const pivot = normal[i][i];
    if (!(pivot > 1e-9 * normal[0][0])) return null;
    for (let k = i + 1; k < 3; k++) {
      const share = normal[k][i] / pivot;
      for (let j = i; j < 3; j++) normal[k][j] -= share * normal[i][j];
      for (let j = 0; j < 2; j++) right[k][j] -= share * right[i][j];
    }
  }
  const found = [[0, 0], [0, 0], [0, 0]];
  for (let i = 2; i >= 0; i--) {
    for (let j = 0; j < 2; j++) {
      let sum = right[i][j];
      for (let k = i + 1; k < 3; k++) sum -= normal[i][k] * found[k][j];
      found[i][j] = sum / normal[i][i];
    }
  }
  return ([x, y]) => [0, 1].map((j) => found[0][j] + found[1][j] * (x - about[0]) + found[2][j] * (y - about[1])) as Point;
}

/** What other cameras say of a marker: where it is, or lines on which it is. */
export interface Known {
  at: Point | null;
  lines: Record<string, Point[][]>;
}

/** So far off a line is not on it, px. */
const LINE_PX = 3;

/** The dots that lie on all lines. */
function allowed(dots: Dot[], known: Known | undefined): Dot[] {
  const lines = Object.values(known?.lines ?? {}).filter((pieces) => pieces.length);
  return dots.filter(({ at }) => lines.every((pieces) => pieces.some((piece) => off(piece, at) < LINE_PX)));
}

/** How far a place is from a polyline. */
function off(line: Point[], at: Point): number {
  let least = Infinity;
  for (let k = 1; k < line.length; k++) {
    const [a, b] = [line[k - 1], line[k]];
    const [dx, dy] = [b[0] - a[0], b[1] - a[1]];
    const share = Math.min(1, Math.max(0, ((at[0] - a[0]) * dx + (at[1] - a[1]) * dy) / (dx * dx + dy * dy || 1)));
    least = Math.min(least, distance(at, [a[0] + share * dx, a[1] + share * dy]));
  }
  return least;
}

/** How a guess is judged: the dot must be this much nearer than the next one, and than the next marker's place. */
const CLEAR = 0.55;

/**
 * Names carried over from a neighbouring camera: the markers that both have tell how images go together around each marker; the next one is
 * taken where the map of its nearest pairs leads to one dot and to no other. Grows outwards from three pairs. `known` is what other cameras say:
 * a place is believed first, and off a line no dot is taken.
 */
export function carried(from: Named, here: Named, dots: Dot[], known: Record<string, Known> = {}): Named {
  const found: Named = {};
  const free = new Set(dots.filter((dot) => !Object.values(here).some((place) => distance(place, dot.at) < 1)));
  const left = new Set(Object.keys(from).filter((marker) => !(marker in here)));
  const take = (marker: string, dot: Dot) => {
    found[marker] = dot.at;
    left.delete(marker);
    free.delete(dot);
  };
  for (const marker of [...left]) {
    const at = known[marker]?.at;
    const dot = at && clearly([...free], at, LINE_PX);
    if (dot) take(marker, dot);
  }
  for (;;) {
    const both = Object.entries({ ...here, ...found }).filter(([marker]) => marker in from);
    const pairs = both.map(([marker, place]) => [from[marker], place] as [Point, Point]);
    let best: { marker: string; dot: Dot; far: number } | null = null;
    for (const marker of left) {
      const around = [...pairs].sort((a, b) => distance(a[0], from[marker]) - distance(b[0], from[marker])).slice(0, 8);
      if (around.length < 3) return found;
      const reach = distance(around[2][0], from[marker]);
      const guess = affine(around, from[marker], reach)?.(from[marker]);
      const dot = guess && clearly(allowed([...free], known[marker]), guess, 0.5 * reach);
      const far = dot ? distance(dot.at, guess) / reach : Infinity;
      if (dot && far < (best?.far ?? Infinity)) best = { marker, dot, far };
    }
    if (!best) return found;
    take(best.marker, best.dot);
  }
}

/** The dot nearest to a place, if no other one is nearly as near. */
function clearly(dots: Dot[], at: Point, reach: number): Dot | null {
  const sorted = dots.map((dot) => ({ dot, far: distance(dot.at, at) })).sort((a, b) => a.far - b.far);
  const [first, second] = sorted;
  if (!first || first.far > reach) return null;
  return !second || first.far < CLEAR * second.far ? first.dot : null;
}
