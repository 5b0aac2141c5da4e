// The character on the graphics card: what never changes is uploaded once, per frame only a few uniforms are set.
import {
  Box3, BufferAttribute, BufferGeometry, DataArrayTexture, DataTexture, DoubleSide, GLSL3, LinearFilter, LinearMipmapLinearFilter, Matrix4, Mesh,
  NearestFilter, NoBlending, NoColorSpace, OrthographicCamera, RawShaderMaterial, RepeatWrapping, RGBAFormat, RGBAIntegerFormat, Scene, Sphere,
  Texture, UnsignedByteType, UnsignedIntType, Vector3, Vector4, WebGLRenderer, WebGLRenderTarget, type IUniform,
} from "three";
import { codes } from "pages/files";
import type { Rig } from "./rig";
import { mapShader, skinShader, vertexShader } from "./shader";
import type { Shares } from "./shares";
import type { About, Block, Part, SceneDocument } from "./scene";

export type Look = "skin" | "clay" | "influence";
const LOOKS: Look[] = ["skin", "clay", "influence"];
const KINDS = { skin: 0, eye: 1, other: 2 };
/** Linear light that skin, and what is neither skin nor eye, throws back. */
const SKIN = new Vector3(0.52, 0.3, 0.215);
const OTHER = new Vector3(0.42, 0.24, 0.21);

/** How much more than the moving part of the face is seen at first. */
const AROUND = 1.35;

interface Drawn {
  part: Part;
  mesh: Mesh<BufferGeometry, RawShaderMaterial>;
  joints: Float32Array;
  inverseBind: Matrix4[];
}

export class Character {
  private readonly drawn: Drawn[];
  private readonly inMap = new Scene();
  readonly common: Record<string, IUniform>;
  readonly textures: Texture[] = [];

  constructor(
    private readonly about: About,
    private readonly block: Block,
    equations: string,
    maps: Texture,
    colors: Texture | null,
    private readonly shares: Shares,
  ) {
    const { scene } = about;
    this.common = {
      shares: { value: shares.table },
      maps: { value: maps },
      shown: { value: 1 },
      lamp: { value: new Vector3(0, 0, 1) },
      brightness: { value: 1 },
      look: { value: 0 },
      poseColors: { value: scene.poses.map((pose) => new Vector3(...pose.color)) },
      colors: { value: colors },
    };
    this.drawn = scene.parts.map((part) => this.upload(part, equations, colors !== null));
    const skin = this.drawn[0];
    const flat = new RawShaderMaterial({
      glslVersion: GLSL3, vertexShader: vertexShader(equations), fragmentShader: mapShader(equations), side: DoubleSide,
      defines: { ...skin.mesh.material.defines, IN_MAP: "" }, uniforms: skin.mesh.material.uniforms,
      blending: NoBlending, depthTest: false, depthWrite: false,
    });
    const mesh = new Mesh(skin.mesh.geometry, flat);
    mesh.frustumCulled = false;
    this.inMap.add(mesh);
  }

  addTo(scene: Scene) {
    this.drawn.forEach(({ mesh }) => scene.add(mesh));
  }

  set look(look: Look) {
    this.common.look.value = LOOKS.indexOf(look);
  }

  /** Follows the bones. */
  update(rig: Rig) {
    this.shares.update(rig);
    const m = new Matrix4();
    for (const { part, joints, inverseBind } of this.drawn) {
      part.joints.forEach((node, joint) => {
        const e = m.multiplyMatrices(rig.worldFromNode[node], inverseBind[joint]).elements;
        for (let row = 0; row < 3; row++) {
          for (let column = 0; column < 4; column++) joints[12 * joint + 4 * row + column] = e[4 * column + row];
        }
      });
    }
  }

  /** A ball about the part of the face that poses move, with some of what is around it, as it stands now. */
  bounds(): Sphere {
    const { part, joints } = this.drawn[0];
    const [positions, ranges, influences] = [this.block.floats(part.positions), this.block.words(part.ranges), this.block.words(part.influences)];
    const weights = new Float32Array(influences.buffer, influences.byteOffset, influences.length);
    const points: Vector3[] = [];
    const all: Vector3[] = [];
    for (let vertex = 0; 3 * vertex < positions.length; vertex++) {
      const [first, count] = [ranges[2 * vertex], ranges[2 * vertex + 1]];
      const bound = new Vector3().fromArray(positions, 3 * vertex);
      const posed = count ? new Vector3() : bound.clone();
      let isFace = false;
      for (let index = first; index < first + count; index++) {
        const [joint, weight] = [influences[4 * index], weights[4 * index + 1]];
        const row = (r: number) => new Vector4().fromArray(joints, 12 * joint + 4 * r).dot(new Vector4(bound.x, bound.y, bound.z, 1));
        posed.addScaledVector(new Vector3(row(0), row(1), row(2)), weight);
        isFace ||= influences[4 * index + 2] !== 0xffffffff && weight > 0.1;
      }
      all.push(posed);
      if (isFace) points.push(posed);
    }
    const whole = new Sphere().setFromPoints(all);
    if (points.length < 3) return whole;
    const face = new Sphere().setFromPoints(points);
    // The brows' bones leave most of the forehead out.
    face.center.y += 0.12 * face.radius;
    return face.radius * AROUND < whole.radius ? new Sphere(face.center, face.radius * AROUND) : whole;
  }

  /** The blended map as the shader has it: red, green, blue, and 255 where the mesh lies; row 0 is the top. */
  blended(renderer: WebGLRenderer): { width: number; height: number; data: Uint8Array } {
    const [width, height] = this.about.map_size;
    const target = new WebGLRenderTarget(width, height, { depthBuffer: false, format: RGBAFormat, type: UnsignedByteType, colorSpace: NoColorSpace });
    const data = new Uint8Array(4 * width * height);
    renderer.setRenderTarget(target);
    renderer.setClearColor(0, 0);
    renderer.clear();
    renderer.render(this.inMap, new OrthographicCamera());
    renderer.readRenderTargetPixels(target, 0, 0, width, height, data);
    renderer.setRenderTarget(null);
    target.dispose();
    return { width, height, data };
  }

  private upload(part: Part, equations: string, hasColors: boolean): Drawn {
    const geometry = new BufferGeometry();
    const add = (name: string, values: Float32Array, size: number) => geometry.setAttribute(name, new BufferAttribute(values, size));
    add("position", this.block.floats(part.positions), 3);
    add("normal", this.block.floats(part.normals), 3);
    add("tangent", this.block.floats(part.tangents), 4);
    add("uv", this.block.floats(part.uvs), 2);
    add("range", new Float32Array(this.block.words(part.ranges)), 2);
    geometry.setIndex(new BufferAttribute(this.block.words(part.triangles), 1));
    const joints = new Float32Array(12 * part.joints.length);
    const binds = this.block.floats(part.inverse_bind);
    const { scene } = this.about;
    const isSkin = part.kind === "skin";
    const material = new RawShaderMaterial({
      glslVersion: GLSL3,
      vertexShader: vertexShader(equations),
      fragmentShader: skinShader(equations),
      side: DoubleSide,
      defines: {
        PART: KINDS[part.kind], JOINTS: part.joints.length, BONES: scene.bones.length, GROUPS: this.shares.groups,
        POSES: scene.poses.length, SMOOTH: scene.smooth ? 1 : 0, ...(isSkin && hasColors ? { COLOR: "" } : {}),
      },
      uniforms: {
        ...this.common,
        joints: { value: joints },
        influences: { value: this.influences(part) },
        plain: { value: isSkin ? SKIN : OTHER },
        eyes: { value: eyeBalls(this.block.floats(part.positions)) },
      },
    });
    const mesh = new Mesh(geometry, material);
    mesh.frustumCulled = false;
    const inverseBind = part.joints.map((_, joint) => new Matrix4().fromArray(binds, 16 * joint));
    return { part, mesh, joints, inverseBind };
  }

  private influences(part: Part): DataTexture {
    const words = this.block.words(part.influences);
    const width = 1024;
    const height = Math.max(1, Math.ceil(words.length / 4 / width));
    const data = new Uint32Array(4 * width * height);
    data.set(words);
    const texture = new DataTexture(data, width, height, RGBAIntegerFormat, UnsignedIntType);
    texture.internalFormat = "RGBA32UI";
    texture.minFilter = texture.magFilter = NearestFilter;
    texture.unpackAlignment = 4;
    texture.needsUpdate = true;
    this.textures.push(texture);
    return texture;
  }
}

/** Centre and radius of a mesh's balls: of two that lie side by side, or the same one twice. */
function eyeBalls(positions: Float32Array): Vector4[] {
  const points = Array.from({ length: positions.length / 3 }, (_, vertex) => new Vector3().fromArray(positions, 3 * vertex));
  const ball = (of: Vector3[]) => {
    const box = new Box3().setFromPoints(of);
    const [center, size] = [box.getCenter(new Vector3()), box.getSize(new Vector3())];
    return { size, ball: new Vector4(center.x, center.y, center.z, Math.max(1e-9, 0.5 * size.x)) };
  };
  const whole = ball(points);
  if (whole.size.x < 1.6 * whole.size.y) return [whole.ball, whole.ball];
  const middle = whole.ball.x;
  return [points.filter((point) => point.x < middle), points.filter((point) => point.x >= middle)].map((side) => ball(side).ball);
}

/** All maps as layers of one texture: the neutral one, then one per pose. */
export async function loadMaps(scene: SceneDocument, [width, height]: [number, number], renderer: WebGLRenderer): Promise<DataArrayTexture> {
  const layers = scene.poses.length + 1;
  const limits = renderer.getContext() as WebGL2RenderingContext;
  const most = [limits.getParameter(limits.MAX_TEXTURE_SIZE), limits.getParameter(limits.MAX_ARRAY_TEXTURE_LAYERS)];
  if (Math.max(width, height) > most[0] || layers > most[1]) {
    throw new Error(`the maps are ${width} × ${height}, ${layers} of them; this graphics card takes ${most[0]} px and ${most[1]} of them`);
  }
  const data = new Uint8Array(4 * width * height * layers);
  const load = async (layer: number) => {
    const map = await codes(`maps/${layer}.png`);
    if (map.width !== width || map.height !== height) throw new Error(`maps/${layer}.png has another size than the neutral map`);
    data.set(map.data, 4 * width * height * layer);
  };
  await Promise.all(Array.from({ length: layers }, (_, layer) => load(layer)));
  const texture = new DataArrayTexture(data, width, height, layers);
  return filtered(texture, renderer);
}

export async function loadColors(renderer: WebGLRenderer): Promise<DataTexture> {
  const { width, height, data } = await codes("color.png");
  return filtered(new DataTexture(new Uint8Array(data.buffer), width, height), renderer);
}

function filtered<T extends Texture>(texture: T, renderer: WebGLRenderer): T {
  texture.colorSpace = NoColorSpace;
  texture.wrapS = texture.wrapT = RepeatWrapping;
  texture.magFilter = LinearFilter;
  texture.minFilter = LinearMipmapLinearFilter;
  texture.generateMipmaps = true;
  texture.anisotropy = Math.min(8, renderer.capabilities.getMaxAnisotropy());
  texture.needsUpdate = true;
  return texture;
}

/** Why a graphics card cannot draw a character, if it cannot. */
export function tooMuch(scene: SceneDocument, renderer: WebGLRenderer): string | null {
  const gl = renderer.getContext() as WebGL2RenderingContext;
  const most: number = gl.getParameter(gl.MAX_VERTEX_UNIFORM_VECTORS);
  const joints = Math.max(...scene.parts.map((part) => part.joints.length));
  const needed = 3 * joints + scene.bones.length * Math.ceil(scene.poses.length / 4) + 16;
  return needed <= most ? null : `${joints} bones and ${scene.poses.length} poses need ${needed} uniforms; this graphics card has ${most}`;
}
