// A view into three dimensions: renderer, camera, orbiting with mouse and keys, drawing only when something changed.
import { PerspectiveCamera, Scene, Vector3, WebGLRenderer } from "three";
import { OrbitControls } from "three/addons/controls/OrbitControls.js";

/** What keys turn the camera by, rad. */
const TURN = 0.08;

export class View {
  readonly renderer: WebGLRenderer;
  readonly scene = new Scene();
  readonly camera = new PerspectiveCamera(26, 1, 0.01, 100);
  private readonly controls: OrbitControls;
  private home = { eye: new Vector3(), target: new Vector3() };
  private asked = false;
  /** Does what must be done before a frame; true if the next one will differ too. */
  before: (seconds: number) => boolean = () => false;
  /** Hears how long the frame before took, and how long this page worked on it, ms. */
  after: (interval: number, work: number) => void = () => {};
  private last = 0;

  constructor(canvas: HTMLCanvasElement) {
    // A picture can be taken of the canvas at any time.
    this.renderer = new WebGLRenderer({ canvas, antialias: true, alpha: true, preserveDrawingBuffer: true });
    this.renderer.setPixelRatio(Math.min(devicePixelRatio, 2));
    this.controls = new OrbitControls(this.camera, canvas);
    this.controls.enableDamping = false;
    this.controls.addEventListener("change", () => this.draw());
    canvas.addEventListener("keydown", (event) => this.key(event));
    new ResizeObserver(() => this.resize()).observe(canvas.parentElement ?? canvas);
    this.resize();
  }

  /** Looks at a ball of a radius from the front, and returns there on `reset`. */
  frame(center: Vector3, radius: number) {
    const distance = (1.12 * radius) / Math.sin((this.camera.fov * Math.PI) / 360);
    this.home = { target: center.clone(), eye: center.clone().add(new Vector3(0.28, 0.06, 1).setLength(distance)) };
    this.camera.near = distance / 50;
    this.camera.far = distance * 20;
    this.controls.minDistance = distance / 8;
    this.controls.maxDistance = distance * 4;
    this.reset();
  }

  reset() {
    this.camera.position.copy(this.home.eye);
    this.controls.target.copy(this.home.target);
    this.camera.updateProjectionMatrix();
    this.controls.update();
    this.draw();
  }

  /** Turns the camera about what it looks at, rad. */
  turn(aside: number, up: number) {
    const arm = this.camera.position.clone().sub(this.controls.target);
    const height = Math.asin(arm.y / arm.length()) + up;
    const angle = Math.atan2(arm.x, arm.z) + aside;
    const limited = Math.max(-1.5, Math.min(1.5, height));
    const flat = Math.cos(limited) * arm.length();
    arm.set(flat * Math.sin(angle), Math.sin(limited) * arm.length(), flat * Math.cos(angle));
    this.camera.position.copy(this.controls.target).add(arm);
    this.controls.update();
    this.draw();
  }

  zoom(factor: number) {
    const arm = this.camera.position.clone().sub(this.controls.target);
    const length = Math.max(this.controls.minDistance, Math.min(this.controls.maxDistance, arm.length() * factor));
    this.camera.position.copy(this.controls.target).add(arm.setLength(length));
    this.controls.update();
    this.draw();
  }

  /** Draws soon, once. */
  draw() {
    if (this.asked) return;
    this.asked = true;
    requestAnimationFrame((now) => this.step(now));
  }

  private step(now: number) {
    this.asked = false;
    const interval = now - this.last;
    this.last = now;
    const start = performance.now();
    // After a rest, no time has passed.
    const goesOn = this.before(Math.min(interval, 100) / 1000);
    this.renderer.render(this.scene, this.camera);
    this.after(interval, performance.now() - start);
    if (goesOn) this.draw();
  }

  private resize() {
    const around = this.renderer.domElement.parentElement;
    if (!around || !around.clientWidth || !around.clientHeight) return;
    this.camera.aspect = around.clientWidth / around.clientHeight;
    this.camera.updateProjectionMatrix();
    this.renderer.setSize(around.clientWidth, around.clientHeight, false);
    this.draw();
  }

  private key(event: KeyboardEvent) {
    const ways: Record<string, () => void> = {
      ArrowLeft: () => this.turn(-TURN, 0),
      ArrowRight: () => this.turn(TURN, 0),
      ArrowUp: () => this.turn(0, TURN),
      ArrowDown: () => this.turn(0, -TURN),
      "+": () => this.zoom(0.9),
      "-": () => this.zoom(1.1),
    };
    const way = ways[event.key];
    if (!way) return;
    event.preventDefault();
    way();
  }
}
