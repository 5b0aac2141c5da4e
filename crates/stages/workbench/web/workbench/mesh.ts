// Meshes from the server, and light to see them by.
import { load } from "pages/files";
import { BufferAttribute, BufferGeometry, DirectionalLight, HemisphereLight, type Object3D, type PerspectiveCamera } from "three";

/** A mesh: counts, coordinates (mm), corners; see the library's `buffers`. */
export async function loadMesh(path: string): Promise<BufferGeometry> {
  const bytes = await (await load(path)).arrayBuffer();
  const [vertices, triangles] = new Uint32Array(bytes, 0, 2);
  const geometry = new BufferGeometry();
  geometry.setAttribute("position", new BufferAttribute(new Float32Array(bytes, 8, 3 * vertices), 3));
  geometry.setIndex(new BufferAttribute(new Uint32Array(bytes, 8 + 12 * vertices, 3 * triangles), 1));
  geometry.computeVertexNormals();
  geometry.computeBoundingSphere();
  return geometry;
}

/** Light that goes with the camera, from above and aside, so that relief is seen from everywhere. */
export function lights(camera: PerspectiveCamera): Object3D[] {
  const lamp = new DirectionalLight(0xffffff, 2.2);
  lamp.position.set(-0.6, 0.8, 0.5);
  camera.add(lamp, lamp.target);
  lamp.target.position.set(0, 0, -1);
  return [new HemisphereLight(0xffffff, 0x554a44, 1.1)];
}
