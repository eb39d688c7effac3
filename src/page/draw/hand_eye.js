import { CylinderGeometry, LineBasicMaterial, Matrix4, Mesh, MeshBasicMaterial, PointsMaterial, Quaternion, SphereGeometry, Vector3 } from 'three';
import { apply } from '../core/kinematics.js';
import { colour } from '../core/theme.js';
import { edgesOf, pyramidOf } from '../core/views.js';
import { axes, place, rod, stretch } from './solids.js';
import { Viewer } from './viewer.js';
import { boardShape, cameraShape, clearFace } from './views.js';

/** The flange, and what it carries with the ellipsoid of its place, `times` as large; `views` as the scene has them. */
export class HandEyeViewer extends Viewer {
  constructor(made, holder, views, ellipsoid, times, size) {
    super(made, holder, { up: [0, 0, 1], front: [1, 0, 0], size });
    const at = views.flange_from_it;
    const origin = [at[3], at[7], at[11]];
    this.own = { line: new LineBasicMaterial({}), face: clearFace(), dots: new PointsMaterial({ size: 3, sizeAttenuation: false }) };
    this.own.blob = new MeshBasicMaterial({ transparent: true, opacity: 0.4, depthWrite: false });
    this.addFlange(origin);
    const isCamera = views.on_flange === 'camera';
    const body = isCamera ? cameraShape(views.cameras[0], 0.5 * size, this.own.line, this.own.face) : boardShape(views.corners, this.own.line, this.own.dots);
    place(body, at);
    const frame = axes(0.25 * size);
    place(frame, at);
    this.scene.add(body, frame, this.ellipsoidOf(origin, ellipsoid, times));
    this.addLabel('flange', [0, 0, -0.2 * size]);
    this.addLabel(views.on_flange, apply(at, isCamera ? [0, 0, 0.55 * size] : views.corners.at(-1)));
    const points = isCamera ? pyramidOf(views.cameras[0].window, 0.5 * size) : edgesOf(views.corners);
    this.open([
      ...points.map((point) => apply(at, point)),
      ...[-1, 1].map((side) => origin.map((value) => value + 0.3 * side * size)),
      [0, 0, -0.2 * size],
      [0.25 * size, 0.25 * size, 0.25 * size],
    ]);
  }

  addFlange(origin) {
    const { size, materials } = this;
    const disc = new Mesh(new CylinderGeometry(0.22 * size, 0.22 * size, 0.08 * size, 32), materials.joint);
    disc.rotation.x = Math.PI / 2;
    disc.position.z = -0.04 * size;
    const stalk = rod(0.02 * size, materials.link);
    stretch(stalk, [0, 0, 0], origin);
    this.scene.add(disc, axes(0.3 * size), stalk);
  }

  ellipsoidOf(origin, ellipsoid, times) {
    const axis = (k) => new Vector3(...ellipsoid[k].direction);
    const turned = new Matrix4().makeBasis(axis(0), axis(1), new Vector3().crossVectors(axis(0), axis(1)));
    const lengths = ellipsoid.map((one) => Math.max(1e-3 * one.half_axis_mm * times, 0.004 * this.size));
    const mesh = new Mesh(new SphereGeometry(1, 40, 28), this.own.blob);
    mesh.matrixAutoUpdate = false;
    mesh.matrix.compose(new Vector3(...origin), new Quaternion().setFromRotationMatrix(turned), new Vector3(...lengths));
    return mesh;
  }

  recolour() {
    this.own.line.color.set(colour('ink'));
    this.own.dots.color.set(colour('ink-soft'));
    this.own.face.color.set(colour('accent'));
    this.own.blob.color.set(colour('second'));
    super.recolour();
  }
}
