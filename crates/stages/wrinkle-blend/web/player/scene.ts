// The scene as the program serves it: a document, and lists of 32-bit numbers in a block beside it.
import { json, load } from "pages/files";

export interface Span {
  offset: number;
  length: number;
}

export interface Part {
  name: string;
  kind: "skin" | "eye" | "other";
  positions: Span;
  normals: Span;
  tangents: Span;
  uvs: Span;
  triangles: Span;
  ranges: Span;
  influences: Span;
  joints: number[];
  inverse_bind: Span;
}

export interface Bone {
  name: string;
  node: number;
  probe: [number, number, number];
  neutral: [number, number, number];
}

export interface Pose {
  id: string;
  color: [number, number, number];
  placements: Span;
  ways: ([number, number, number] | null)[];
}

export interface Clip {
  name: string;
  hz: number;
  frames: number;
  nodes: number[];
  placements: Span;
}

export interface Expression {
  name: string;
  weights: number[];
  lacks: string[];
}

export interface SceneDocument {
  mm_per_unit: number;
  nodes: { name: string; parent: number | null }[];
  neutral: Span;
  head: number;
  bones: Bone[];
  poses: Pose[];
  modulation: [number, number][] | null;
  dual: boolean;
  smooth: boolean;
  expressions: Expression[];
  clips: Clip[];
  parts: Part[];
}

export interface About {
  scene: SceneDocument;
  map_size: [number, number];
  color: boolean;
  about: { character: string; mesh: string };
}

/** The block of numbers. */
export class Block {
  constructor(private readonly bytes: ArrayBuffer) {}

  floats({ offset, length }: Span): Float32Array<ArrayBuffer> {
    return new Float32Array(this.bytes, offset, length);
  }

  words({ offset, length }: Span): Uint32Array<ArrayBuffer> {
    return new Uint32Array(this.bytes, offset, length);
  }
}

export async function loadScene(): Promise<{ about: About; block: Block; equations: string }> {
  const [about, bytes, equations] = await Promise.all([
    json<About>("scene.json"),
    load("scene.bin").then((answer) => answer.arrayBuffer()),
    load("equations.glsl").then((answer) => answer.text()),
  ]);
  return { about, block: new Block(bytes), equations };
}
