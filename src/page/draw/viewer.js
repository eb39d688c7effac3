import {
  Box3, Color, DirectionalLight, HemisphereLight, InstancedMesh, Line, Matrix4, MeshBasicMaterial, PerspectiveCamera,
  Scene, SphereGeometry, Vector3, WebGLRenderer, BufferGeometry,
} from 'three';
import { OrbitControls } from 'three/addons/controls/OrbitControls.js';
import { el } from '../core/dom.js';
import { apply, flange, frames, origin, way } from '../core/kinematics.js';
import { colour, onTheme } from '../core/theme.js';
import { drawCell } from './cell.js';
import { Robot } from './robot.js';
import { lines, makeMaterials } from './solids.js';

const palette = {
  link: 'robot', joint: 'robot-joint', instrument: 'ink', seen: 'accent', unseen: 'muted', obstacle: 'obstacle',
  wall: 'obstacle', edge: 'muted', faint: 'rule', sight: 'accent', way: 'muted',
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
    this.scene = new Scene();
    this.camera = new PerspectiveCamera(32, 1, 0.01, 500);
    const up = [2, 6, 10].map((k) => scene.world_from_base[k]);
    this.camera.up.set(...(typeof scene.floor_z === 'number' ? [0, 0, 1] : up));
    this.size = this.measure();
    this.robot = new Robot(scene, this.materials, this.size);
    const cell = drawCell(scene, this.materials, this.size);
    this.scene.add(this.robot.group, cell.group);
    this.addLights();
    this.addPoses(colours);
    this.labels = cell.labels.map(({ world, text }) => {
      const label = el('span', { class: 'label', 'aria-hidden': 'true' }, text);
      holder.append(label);
      return { label, world: new Vector3(...world) };
    });
    this.controls = new OrbitControls(this.camera, canvas);
    this.controls.addEventListener('change', () => this.request());
    this.look('all');
    onTheme(() => this.recolour());
    new ResizeObserver(() => this.resize()).observe(holder);
    this.resize();
  }

  /** Reach of the robot in these poses, m; and what is to be in view. */
  measure() {
    this.box = new Box3();
    for (const pose of this.poses) {
      for (const frame of frames(this.data, pose.joints)) this.box.expandByPoint(new Vector3(...origin(frame)));
    }
    return Math.max(this.box.getSize(new Vector3()).length() / 2, 0.05);
  }

  addLights() {
    const { up } = this.camera;
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
    this.dots = new InstancedMesh(new SphereGeometry(0.016 * this.size, 12, 8), new MeshBasicMaterial({}), this.poses.length);
    this.places.forEach((point, k) => {
      this.dots.setMatrixAt(k, new Matrix4().makeTranslation(...point));
      this.dots.setColorAt(k, new Color(colours[k]));
    });
    this.scene.add(this.dots);
    if (this.poses.length < 2 || !this.poses[0].hasWay) return;
    const points = this.poses.slice(1).flatMap((pose, k) =>
      way(this.poses[k].joints, pose.joints, pose.via, 10).map((joints) => new Vector3(...place(joints))));
    this.scene.add(new Line(new BufferGeometry().setFromPoints(points), this.materials.way));
  }

  recolour() {
    for (const [name, variable] of Object.entries(palette)) this.materials[name].color.set(colour(variable));
    this.renderer.setClearColor(colour('stage'));
    this.render();
  }

  /** `all`, `front`, `side` or `top`. */
  look(from) {
    const { up } = this.camera;
    const front = new Vector3(...[0, 4, 8].map((k) => this.data.world_from_base[k]));
    const side = new Vector3().crossVectors(up, front).normalize();
    const centre = this.box.getCenter(new Vector3());
    const direction = {
      all: new Vector3().addScaledVector(front, 1).addScaledVector(side, -1.1).addScaledVector(up, 0.7),
      front: front.clone(), side: side.clone().negate(),
      top: new Vector3().addScaledVector(up, 1).addScaledVector(front, -0.002),
    }[from].normalize();
    this.controls.target.copy(centre);
    this.camera.position.copy(centre).addScaledVector(direction, 4.1 * this.size);
    this.controls.update();
    this.render();
  }

  /** The robot in a configuration. */
  show(joints, seen) {
    const targets = this.robot.show(joints, seen ?? null);
    if (this.sight) {
      this.scene.remove(this.sight);
      this.sight.geometry.dispose();
    }
    const from = this.data.instrument?.position;
    this.sight = lines(from ? targets.filter((one) => one.isSeen).flatMap((one) => [from, one.world]) : [], this.materials.sight);
    this.scene.add(this.sight);
    this.render();
  }

  showFrames(isShown) {
    this.robot.frameAxes.visible = isShown;
    this.render();
  }

  resize() {
    const { clientWidth: width, clientHeight: height } = this.holder;
    if (width === 0 || height === 0) return;
    this.renderer.setPixelRatio(Math.min(devicePixelRatio, 2));
    this.renderer.setSize(width, height, false);
    this.camera.aspect = width / height;
    this.camera.updateProjectionMatrix();
    this.render();
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
    for (const { label, world } of this.labels ?? []) {
      const at = world.clone().project(this.camera);
      label.hidden = Math.abs(at.x) > 0.98 || Math.abs(at.y) > 0.98 || at.z > 1;
      label.style.transform = `translate(-50%, -50%) translate(${((at.x + 1) / 2) * width}px, ${((1 - at.y) / 2) * height}px)`;
    }
  }
}
