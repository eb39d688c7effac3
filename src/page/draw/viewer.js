import {
  Box3,
  Color,
  DirectionalLight,
  HemisphereLight,
  InstancedMesh,
  Line,
  Matrix4,
  MeshBasicMaterial,
  OrthographicCamera,
  PerspectiveCamera,
  Scene,
  SphereGeometry,
  Vector3,
  WebGLRenderer,
  BufferGeometry,
} from 'three';
import { OrbitControls } from 'three/addons/controls/OrbitControls.js';
import { el } from '../core/dom.js';
import { short } from '../core/format.js';
import { apply, flange, frames, origin, way } from '../core/kinematics.js';
import { colour, isOnPaper, onTheme } from '../core/theme.js';
import { ticks } from './canvas.js';
import { drawCell } from './cell.js';
import { Robot } from './robot.js';
import { lines, makeMaterials } from './solids.js';

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

/** Draws a scene with its robot in one configuration at a time. Renders on demand only. */
export class Viewer {
  constructor({ canvas, context }, holder, scene, poses, colours) {
    this.canvas = canvas;
    this.holder = holder;
    this.data = scene;
    this.poses = poses;
    this.materials = makeMaterials();
    this.renderer = new WebGLRenderer({ canvas, context, antialias: true });
    this.renderer.debug.checkShaderErrors = false;
    this.scene = new Scene();
    this.cameras = { perspective: new PerspectiveCamera(32, 1, 0.01, 500), parallel: new OrthographicCamera() };
    this.camera = this.cameras.perspective;
    this.up = new Vector3(...(typeof scene.floor_z === 'number' ? [0, 0, 1] : [2, 6, 10].map((k) => scene.world_from_base[k])));
    for (const camera of Object.values(this.cameras)) camera.up.copy(this.up);
    this.size = this.measure();
    this.robot = new Robot(scene, this.materials, this.size);
    const cell = drawCell(scene, this.materials, this.size);
    this.scene.add(this.robot.group, cell.group);
    this.addLights();
    this.addPoses(colours);
    this.labels = cell.labels.map(({ world, text }) => this.addLabel(text, world));
    this.current = this.addLabel('', [0, 0, 0]);
    this.current.label.classList.add('label-pose');
    this.labels.push(this.current);
    this.scale = el('span', { class: 'scale-bar' });
    holder.append(this.scale);
    this.controls = new OrbitControls(this.camera, canvas);
    this.controls.addEventListener('change', () => this.request());
    [this.aspect, this.fitted, this.tall] = [1, 1, this.size];
    this.resize();
    this.look('all');
    onTheme(() => this.recolour());
    new ResizeObserver(() => this.resize()).observe(holder);
  }

  /** Points of the robot in these poses and of what else is to be in view; gives the robot's size, m. */
  measure() {
    const places = this.poses.flatMap((pose) => frames(this.data, pose.joints).map(origin));
    this.near = places.map((place) => new Vector3(...place));
    const others = [
      this.data.instrument?.position,
      ...(this.data.boxes ?? []).filter((one) => one.kind === 'keep_out').map((one) => origin(one.world_from_box)),
    ];
    const solids = (this.data.capsules ?? [])
      .filter((one) => one.kind === 'keep_out')
      .flatMap(({ from, to, radius }) =>
        [from, to].flatMap((end) => [-radius, radius].map((off) => apply(this.data.world_from_base, end).map((value) => value + off))),
      );
    this.whole = [...this.near, ...[...others, ...solids].filter(Boolean).map((place) => new Vector3(...place))];
    return Math.max(new Box3().setFromPoints(this.near).getSize(new Vector3()).length() / 2, 0.05);
  }

  addLabel(text, world) {
    const label = el('span', { class: 'label', 'aria-hidden': 'true' }, text);
    this.holder.append(label);
    return { label, world: new Vector3(...world) };
  }

  addLights() {
    const { up } = this;
    const sky = new HemisphereLight(0xffffff, 0x99a0a8, 1.9);
    sky.position.copy(up);
    const sun = new DirectionalLight(0xffffff, 1.6);
    sun.position.set(1, -2, 0).addScaledVector(up, 3);
    this.scene.add(sky, sun);
  }

  /** A dot where each pose has the first target, and the way between them. */
  addPoses(colours) {
    const at = this.data.targets?.positions?.[0] ?? [0, 0, 0];
    const place = (joints) => apply(flange(this.data, joints), at);
    this.places = this.poses.map((pose) => place(pose.joints));
    const isMany = this.poses.length > 100;
    this.dots = new InstancedMesh(
      new SphereGeometry((isMany ? 0.012 : 0.02) * this.size, isMany ? 8 : 16, isMany ? 6 : 10),
      new MeshBasicMaterial({}),
      this.poses.length,
    );
    this.places.forEach((point, k) => {
      this.dots.setMatrixAt(k, new Matrix4().makeTranslation(...point));
    });
    this.colourDots = () => {
      this.places.forEach((unused, k) => this.dots.setColorAt(k, new Color(colours(k))));
      this.dots.instanceColor.needsUpdate = true;
    };
    this.scene.add(this.dots);
    if (this.poses.length < 2 || !this.poses[0].hasWay) return;
    const points = this.poses
      .slice(1)
      .flatMap((pose, k) => way(this.poses[k].joints, pose.joints, pose.via, 10).map((joints) => new Vector3(...place(joints))));
    this.scene.add(new Line(new BufferGeometry().setFromPoints(points), this.materials.way));
  }

  recolour() {
    this.resize();
    for (const [name, variable] of Object.entries(palette)) this.materials[name].color.set(colour(variable));
    this.colourDots();
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

  /** From the side where robot and instrument stand apart `all`, or the `robot` alone; `front`, `side` and `top` as drawings: parallel, of all, with a scale. */
  look(from) {
    const { up } = this;
    const front = new Vector3(...[0, 4, 8].map((k) => this.data.world_from_base[k]));
    const side = new Vector3().crossVectors(up, front).normalize();
    const oblique = this.beside(front).addScaledVector(up, 0.42);
    const direction = { all: oblique, robot: oblique, front, side: side.negate(), top: up.clone().addScaledVector(front, -0.002) }[from].normalize();
    this.camera = this.cameras[from === 'all' || from === 'robot' ? 'perspective' : 'parallel'];
    this.controls.object = this.camera;
    this.fit(from === 'robot' ? this.near : this.whole, direction);
    this.resize();
    this.controls.update();
    this.request();
  }

  /** Stands where all points are in view, in the middle of it. */
  fit(points, direction) {
    const { camera, cameras } = this;
    const centre = new Box3().setFromPoints(points).getCenter(new Vector3());
    const half = Math.tan((cameras.perspective.fov * Math.PI) / 360);
    const room = 0.24 * this.size;
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

  /** A level direction from which robot and instrument stand side by side. */
  beside(front) {
    const { up } = this;
    const at = this.data.instrument?.position;
    if (!at) return front.clone().addScaledVector(new Vector3().crossVectors(up, front), -1.1).normalize();
    const between = new Vector3(...at).sub(new Vector3(...origin(this.data.world_from_base)));
    const across = new Vector3().crossVectors(up, between).normalize();
    // From the side that the robot reaches to rather than from behind it, and a little from the instrument.
    const middle = new Box3().setFromPoints(this.near).getCenter(new Vector3());
    const isFront = middle.sub(new Vector3(...origin(this.data.world_from_base))).dot(across) >= 0;
    return across
      .multiplyScalar(isFront ? 1 : -1)
      .addScaledVector(between.normalize(), 0.55)
      .normalize();
  }

  /** The robot in a configuration, and the name of the pose if it is one. */
  show(joints, seen, name) {
    const targets = this.robot.show(joints, seen ?? null);
    if (this.sight) {
      this.scene.remove(this.sight);
      this.sight.geometry.dispose();
    }
    const from = this.data.instrument?.position;
    this.sight = lines(from ? targets.filter((one) => one.isSeen).flatMap((one) => [from, one.world]) : [], this.materials.sight);
    this.scene.add(this.sight);
    this.current.world.set(...(targets[0]?.world ?? origin(flange(this.data, joints))));
    this.current.label.textContent = name;
    this.request();
  }

  showFrames(isShown) {
    this.robot.frameAxes.visible = isShown;
    this.request();
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
    for (const { label, world } of this.labels ?? []) {
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
