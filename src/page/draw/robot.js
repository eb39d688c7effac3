import { Group } from 'three';
import { apply, frames, origin } from '../core/kinematics.js';
import { axes, ball, capsule, place, rod, stretch } from './solids.js';

/** The robot of a scene: its links where the campaign states them, else rods between its frames. */
export class Robot {
  constructor(scene, materials, size) {
    this.scene = scene;
    this.materials = materials;
    this.group = new Group();
    this.frameAxes = new Group();
    this.group.add(this.frameAxes);
    this.addLinks(size);
    this.addTargets(size);
    this.addFrames(size);
  }

  addLinks(size) {
    this.links = (this.scene.capsules ?? [])
      .filter((one) => one.kind === 'link')
      .map((one) => {
        const holder = new Group();
        holder.add(capsule(one.from, one.to, one.radius, this.materials.link));
        this.group.add(holder);
        return { holder, after: one.after_element };
      });
    const radius = this.links.length > 0 ? 0.012 * size : 0.026 * size;
    this.rods = [];
    this.scene.elements.forEach((element, k) => {
      if (element.motion[0] === 'T') {
        const mesh = rod(radius, this.materials.link);
        this.rods.push({ mesh, after: k });
        this.group.add(mesh);
      } else if (element.joints.length > 0) {
        const mesh = ball(1.6 * radius, this.materials.joint);
        this.rods.push({ mesh, at: k + 1 });
        this.group.add(mesh);
      }
    });
  }

  addTargets(size) {
    this.targets = (this.scene.targets?.positions ?? []).map((position) => {
      const mesh = ball(0.016 * size, this.materials.unseen);
      const stalk = rod(0.006 * size, this.materials.link);
      this.group.add(mesh, stalk);
      return { mesh, stalk, position };
    });
  }

  addFrames(size) {
    const driven = this.scene.elements.map((element, k) => (element.joints.length > 0 ? k + 1 : -1));
    this.drawnFrames = [0, ...driven.filter((k) => k > 0), this.scene.elements.length].map((at) => {
      const one = axes(0.09 * size);
      this.frameAxes.add(one);
      return { one, at };
    });
  }

  /** Moves it; `seen` are numbers of targets from 1, null: unknown. Gives world places of targets. */
  show(joints, seen) {
    const list = frames(this.scene, joints);
    for (const { holder, after } of this.links) place(holder, list[after]);
    for (const { mesh, after, at } of this.rods) {
      if (at === undefined) stretch(mesh, origin(list[after]), origin(list[after + 1]));
      else mesh.position.set(...origin(list[at]));
    }
    for (const { one, at } of this.drawnFrames) place(one, list[at]);
    return this.targets.map(({ mesh, stalk, position }, k) => {
      const world = apply(list.at(-1), position);
      const isSeen = seen === null || seen.includes(k + 1);
      mesh.position.set(...world);
      mesh.material = isSeen ? this.materials.seen : this.materials.unseen;
      stretch(stalk, origin(list.at(-1)), world);
      return { world, isSeen };
    });
  }
}
