import { Box3, BufferGeometry, Color, InstancedMesh, Line, Matrix4, MeshBasicMaterial, SphereGeometry, Vector3 } from 'three';
import { apply, flange, frames, origin, way } from '../core/kinematics.js';
import { drawCell } from './cell.js';
import { Robot } from './robot.js';
import { lines } from './solids.js';
import { Viewer } from './viewer.js';
import { CameraViews } from './views.js';

const upOf = (scene) => (typeof scene.floor_z === 'number' ? [0, 0, 1] : [2, 6, 10].map((k) => scene.world_from_base[k]));

/** Places of the robot in these poses. */
const placesOf = (scene, poses) => poses.flatMap((pose) => frames(scene, pose.joints).map(origin));

const sizeOf = (places) =>
  Math.max(
    new Box3()
      .setFromPoints(places.map((place) => new Vector3(...place)))
      .getSize(new Vector3())
      .length() / 2,
    0.05,
  );

/** A scene with its robot in one configuration at a time, its poses and, of a camera, its `views` (of the poses first). */
export class RobotViewer extends Viewer {
  constructor(made, holder, scene, poses, colours, views) {
    const places = placesOf(scene, poses);
    super(made, holder, { up: upOf(scene), front: [0, 4, 8].map((k) => scene.world_from_base[k]), size: sizeOf(places) });
    Object.assign(this, { data: scene, poses, robotPlaces: places });
    this.robot = new Robot(scene, this.materials, this.size);
    const cell = drawCell(scene, this.materials, this.size);
    this.scene.add(this.robot.group, cell.group);
    this.addPoses(colours, Boolean(views));
    if (views) this.addViews(views, colours);
    for (const { world, text } of cell.labels) this.addLabel(text, world);
    this.current = this.addLabel('', [0, 0, 0]);
    this.current.label.classList.add('label-pose');
    this.open([...places, ...this.wayPlaces, ...this.surroundings(), ...(this.views?.extent() ?? [])], places);
  }

  /** Points of what stands around the robot and is to be in view. */
  surroundings() {
    const { instrument, boxes, capsules, world_from_base: worldFromBase } = this.data;
    const solids = (capsules ?? [])
      .filter((one) => one.kind === 'keep_out')
      .flatMap(({ from, to, radius }) => [from, to].flatMap((end) => [-radius, radius].map((off) => apply(worldFromBase, end).map((value) => value + off))));
    const others = (boxes ?? []).filter((one) => one.kind === 'keep_out').map((one) => origin(one.world_from_box));
    return [instrument?.position, ...others, ...solids].filter(Boolean);
  }

  /** A dot where each pose has the first target, `isSmall` beside what is drawn there, and the way between them. */
  addPoses(colours, isSmall) {
    const at = this.data.targets?.positions?.[0] ?? [0, 0, 0];
    const place = (joints) => apply(flange(this.data, joints), at);
    this.places = this.poses.map((pose) => place(pose.joints));
    const isMany = isSmall || this.poses.length > 100;
    this.dots = new InstancedMesh(
      new SphereGeometry((isSmall ? 0.007 : isMany ? 0.012 : 0.02) * this.size, isMany ? 8 : 16, isMany ? 6 : 10),
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
    this.wayPlaces = [];
    if (this.poses.length < 2 || !this.poses[0].hasWay) return;
    this.wayPlaces = this.poses.slice(1).flatMap((pose, k) => way(this.poses[k].joints, pose.joints, pose.via, 10).map(place));
    const points = this.wayPlaces.map((point) => new Vector3(...point));
    this.scene.add(new Line(new BufferGeometry().setFromPoints(points), this.materials.way));
  }

  addViews(views, colours) {
    this.views = new CameraViews(this.data.views, views, colours, this.size);
    this.scene.add(this.views.group);
    for (const { id, place, contradicts } of views) if (contradicts) this.addLabel(`${id} contradicts`, origin(place)).label.classList.add('label-pose');
  }

  recolour() {
    this.colourDots();
    this.views?.recolour(Color);
    super.recolour();
  }

  oblique() {
    const { up } = this;
    return this.data.instrument ? this.beside().addScaledVector(up, 0.42) : super.oblique();
  }

  /** A level direction from which robot and instrument stand side by side. */
  beside() {
    const { up } = this;
    const at = this.data.instrument.position;
    const between = new Vector3(...at).sub(new Vector3(...origin(this.data.world_from_base)));
    const across = new Vector3().crossVectors(up, between).normalize();
    // From the side that the robot reaches to rather than from behind it, and a little from the instrument.
    const middle = new Box3().setFromPoints(this.robotPlaces.map((place) => new Vector3(...place))).getCenter(new Vector3());
    const isFront = middle.sub(new Vector3(...origin(this.data.world_from_base))).dot(across) >= 0;
    return across
      .multiplyScalar(isFront ? 1 : -1)
      .addScaledVector(between.normalize(), 0.55)
      .normalize();
  }

  /** Only cameras and board. */
  lookAtViews() {
    const points = this.views.extent().map((point) => new Vector3(...point));
    this.look('views', points, 0.04 * new Box3().setFromPoints(points).getSize(new Vector3()).length());
  }

  showViews(isShown) {
    this.views.group.visible = isShown;
    this.request();
  }

  /** The robot in a configuration, the targets seen (null: unknown), the name of the pose if it is one, and the cameras that see the board. */
  show(joints, seen, name, cameras) {
    const targets = this.robot.show(joints, seen ?? null);
    if (this.sight) {
      this.scene.remove(this.sight);
      this.sight.geometry.dispose();
    }
    const from = this.data.instrument?.position;
    const rays = from ? targets.filter((one) => one.isSeen).flatMap((one) => [from, one.world]) : [];
    this.sight = lines([...rays, ...(this.views?.show(flange(this.data, joints), cameras ?? []) ?? [])], this.materials.sight);
    this.scene.add(this.sight);
    this.current.world.set(...(targets[0]?.world ?? origin(flange(this.data, joints))));
    this.current.label.textContent = name;
    this.request();
  }

  showFrames(isShown) {
    this.robot.frameAxes.visible = isShown;
    this.request();
  }
}
