import { Box3, DirectionalLight, HemisphereLight, OrthographicCamera, PerspectiveCamera, Scene, Vector3, WebGLRenderer } from 'three';
import { OrbitControls } from 'three/addons/controls/OrbitControls.js';
import { el } from '../core/dom.js';
import { short } from '../core/format.js';
import { colour, isOnPaper, onTheme } from '../core/theme.js';
import { ticks } from './canvas.js';
import { makeMaterials } from './solids.js';

const palette = {
  link: 'robot',
  joint: 'robot-joint',
  instrument: 'ink',
  seen: 'accent',
  unseen: 'muted',
  obstacle: 'obstacle',
  wall: 'obstacle',
  edge: 'muted',
  faint: 'rule',
  sight: 'accent',
  way: 'muted',
};

/** A canvas with a WebGL 2 context; null where there is none. */
export function makeCanvas() {
  const canvas = el('canvas', { tabindex: 0, role: 'img' });
  const context = canvas.getContext('webgl2', { antialias: true, preserveDrawingBuffer: true });
  return context ? { canvas, context } : null;
}

/** Draws what it is given in 3D, with labels. Renders on demand only. */
export class Viewer {
  /** `up` and `front`: directions to look along; `size` of what is drawn, m. */
  constructor({ canvas, context }, holder, { up, front, size }) {
    Object.assign(this, { canvas, holder, size, up: new Vector3(...up), front: new Vector3(...front), labels: [] });
    this.materials = makeMaterials();
    this.renderer = new WebGLRenderer({ canvas, context, antialias: true });
    this.renderer.debug.checkShaderErrors = false;
    this.scene = new Scene();
    this.cameras = { perspective: new PerspectiveCamera(32, 1, 0.01 * Math.min(size, 1), 500), parallel: new OrthographicCamera() };
    this.camera = this.cameras.perspective;
    for (const camera of Object.values(this.cameras)) camera.up.copy(this.up);
    this.addLights();
  }

  /** Shows what was added, so that the points `whole` are in view, or `near` of them. */
  open(whole, near = whole) {
    [this.whole, this.near] = [whole, near].map((points) => points.map((point) => new Vector3(...point)));
    this.scale = el('span', { class: 'scale-bar' });
    this.holder.append(this.scale);
    this.controls = new OrbitControls(this.camera, this.canvas);
    this.controls.addEventListener('change', () => this.request());
    [this.aspect, this.fitted, this.tall] = [1, 1, this.size];
    this.resize();
    this.look('all');
    onTheme(() => this.recolour());
    new ResizeObserver(() => this.resize()).observe(this.holder);
  }

  addLabel(text, world) {
    const label = el('span', { class: 'label', 'aria-hidden': 'true' }, text);
    this.holder.append(label);
    this.labels.push({ label, world: new Vector3(...world) });
    return this.labels.at(-1);
  }

  addLights() {
    const { up } = this;
    const sky = new HemisphereLight(0xffffff, 0x99a0a8, 1.9);
    sky.position.copy(up);
    const sun = new DirectionalLight(0xffffff, 1.6);
    sun.position.set(1, -2, 0).addScaledVector(up, 3);
    this.scene.add(sky, sun);
  }

  recolour() {
    this.resize();
    for (const [name, variable] of Object.entries(palette)) this.materials[name].color.set(colour(variable));
    this.renderer.setClearColor(colour('stage'));
    // At once: paper does not wait.
    this.render();
    this.copy?.remove();
    if (!isOnPaper()) return;
    // Browsers do not print a 3D canvas as it is drawn for paper, but a copy.
    const { width, height } = this.canvas;
    this.copy = el('canvas', { class: 'stage-copy', width, height, 'aria-hidden': 'true' });
    this.copy.getContext('2d').drawImage(this.canvas, 0, 0);
    this.canvas.after(this.copy);
  }

  /** Where to look from at all of it. */
  oblique() {
    const { up, front } = this;
    return front.clone().addScaledVector(new Vector3().crossVectors(up, front), -1.1).normalize().addScaledVector(up, 0.42);
  }

  /** `all` obliquely, or what is `near`, or other `points`; `front`, `side` and `top` as drawings: parallel, of all, with a scale. */
  look(from, points = from === 'near' ? this.near : this.whole, room = 0.24 * this.size) {
    const { up, front } = this;
    const side = new Vector3().crossVectors(up, front).normalize();
    const parallel = { front, side: side.negate(), top: up.clone().addScaledVector(front, -0.002) }[from];
    this.camera = this.cameras[parallel ? 'parallel' : 'perspective'];
    this.controls.object = this.camera;
    this.fit(points, (parallel ?? this.oblique()).clone().normalize(), room);
    this.resize();
    this.controls.update();
    this.request();
  }

  /** Stands where all points are in view, in the middle of it, with room around them, m. */
  fit(points, direction, room) {
    const { camera, cameras } = this;
    const centre = new Box3().setFromPoints(points).getCenter(new Vector3());
    const half = Math.tan((cameras.perspective.fov * Math.PI) / 360);
    let away = 4 * this.size;
    for (let k = 0; k < 6; ++k) {
      camera.position.copy(centre).addScaledVector(direction, away);
      camera.lookAt(centre);
      camera.updateMatrixWorld();
      const eye = camera.matrixWorld.clone().invert();
      const seen = new Box3().setFromPoints(points.map((point) => point.clone().applyMatrix4(eye)));
      const middle = seen.getCenter(new Vector3()).setZ(0).applyQuaternion(camera.quaternion);
      centre.add(middle);
      // What is near the eye takes the most room; the middle depth does for a first guess, the front is safe.
      const extent = seen.getSize(new Vector3());
      this.tall = Math.max((extent.x / 2 + room) / this.aspect, extent.y / 2 + room);
      away = this.tall / half + 0.3 * extent.z;
    }
    this.fitted = this.aspect;
    this.controls.target.copy(centre);
    camera.position.copy(centre).addScaledVector(direction, away);
    // A parallel view cuts nothing off before or behind.
    Object.assign(cameras.parallel, { zoom: 1, near: -100 * this.size, far: 100 * this.size });
  }

  resize() {
    const { clientWidth: width, clientHeight: height } = this.holder;
    if (width === 0 || height === 0) return;
    this.renderer.setPixelRatio(isOnPaper() ? 2 : Math.min(devicePixelRatio, 2));
    this.renderer.setSize(width, height, false);
    this.aspect = width / height;
    // As wide a view as it was fitted to.
    const wider = Math.max(1, this.fitted / this.aspect);
    Object.assign(this.cameras.perspective, { aspect: this.aspect, zoom: 1 / wider });
    const top = this.tall * wider;
    Object.assign(this.cameras.parallel, { top, bottom: -top, left: -top * this.aspect, right: top * this.aspect });
    this.camera.updateProjectionMatrix();
    this.request();
  }

  request() {
    this.waiting ??= requestAnimationFrame(() => {
      this.waiting = null;
      this.render();
    });
  }

  render() {
    this.renderer.render(this.scene, this.camera);
    const { clientWidth: width, clientHeight: height } = this.holder;
    this.showScale(height);
    for (const { label, world } of this.labels) {
      const at = world.clone().project(this.camera);
      label.hidden = Math.abs(at.x) > 0.98 || Math.abs(at.y) > 0.98 || at.z > 1;
      label.style.transform = `translate(-50%, -50%) translate(${((at.x + 1) / 2) * width}px, ${((1 - at.y) / 2) * height}px)`;
    }
  }

  /** A bar of a round length, about a quarter of the height; in perspective there is none. */
  showScale(height) {
    const { parallel } = this.cameras;
    this.scale.hidden = this.camera !== parallel;
    const pixels = (height * parallel.zoom) / (2 * parallel.top);
    const length = ticks(0, height / pixels, 4)[1];
    this.scale.style.width = `${length * pixels}px`;
    this.scale.textContent = length < 1 ? `${short(1e3 * length, 3)} mm` : `${short(length, 3)} m`;
  }
}
