import {
  BufferGeometry,
  DoubleSide,
  Float32BufferAttribute,
  Group,
  LineBasicMaterial,
  LineSegments,
  Mesh,
  MeshBasicMaterial,
  Points,
  PointsMaterial,
} from 'three';
import { apply, identity, multiply } from '../core/kinematics.js';
import { edgesOf, kinds, pyramidOf } from '../core/views.js';
import { colour } from '../core/theme.js';
import { axes, place } from './solids.js';

const geometryOf = (points) => new BufferGeometry().setAttribute('position', new Float32BufferAttribute(points.flat(), 3));

/** How many points pyramidOf() has. */
const pyramidEnds = 20;

/** Faces of the pyramid of these edges. */
const facesOf = (edges) => [0, 4, 8, 12].flatMap((k) => [edges[k], edges[k + 1], edges[k + 3]]);

const wideOf = ([left, top, right, bottom]) => Math.max(right - left, bottom - top, 0.4);

/** A camera of this width, or a board, that its parent places: `lines` in a material, perhaps `faces` in another. */
export function cameraShape({ window }, width, line, face) {
  const edges = pyramidOf(window, width / wideOf(window));
  const group = new Group();
  group.add(new LineSegments(geometryOf(edges), line));
  if (face) group.add(new Mesh(geometryOf(facesOf(edges)), face));
  return group;
}

export function boardShape(corners, line, dots) {
  const group = new Group();
  group.add(new LineSegments(geometryOf(edgesOf(corners)), line));
  if (dots) group.add(new Points(geometryOf(corners), dots));
  return group;
}

export const clearFace = () => new MeshBasicMaterial({ transparent: true, opacity: 0.25, side: DoubleSide, depthWrite: false });

/** Cameras and board in the world: what stands, what is on the flange at each view, and the one that is shown now. */
export class CameraViews {
  /** `colours(k)`: of the part's pose k, as its dot has. */
  constructor({ on_flange: moved, flange_from_it: onFlange, cameras, corners }, views, colours, size) {
    Object.assign(this, { isCamera: moved === 'camera', onFlange, cameras, corners, views, colours, size });
    this.group = new Group();
    this.materials = {
      stand: new LineBasicMaterial({}),
      dots: new PointsMaterial({ size: 3, sizeAttenuation: false }),
      now: new LineBasicMaterial({}),
      face: clearFace(),
      odd: clearFace(),
    };
    this.addStanding();
    this.addViews();
    this.addCurrent();
  }

  addStanding() {
    const { materials, size } = this;
    const board = () => {
      const frame = axes(0.06 * size);
      frame.material.depthTest = true;
      return [boardShape(this.corners, materials.stand, materials.dots), frame];
    };
    const rig = () =>
      this.cameras.map((camera) => {
        const shape = cameraShape(camera, 0.16 * size, materials.stand);
        place(shape, camera.in_first);
        return shape;
      });
    this.group.add(...(this.isCamera ? board() : rig()));
  }

  /** Edges of what the flange carries at a view. */
  edgesAt({ place: world, cameras }) {
    if (!this.isCamera) return edgesOf(this.corners).map((point) => apply(world, point));
    return cameras.flatMap((k) => {
      const { in_first: inFirst, window } = this.cameras[k];
      const at = multiply(world, inFirst);
      return pyramidOf(window, (0.055 * this.size) / wideOf(window)).map((point) => apply(at, point));
    });
  }

  addViews() {
    const counts = [];
    const points = this.views.flatMap((view) => {
      const edges = this.edgesAt(view);
      counts.push(edges.length);
      return edges;
    });
    const geometry = geometryOf(points);
    geometry.setAttribute('color', new Float32BufferAttribute(new Float32Array(3 * points.length), 3));
    const lines = new LineSegments(geometry, new LineBasicMaterial({ vertexColors: true }));
    const odd = this.isCamera ? this.views.filter((view) => view.contradicts) : [];
    const faces = odd.flatMap((view) => this.edgesAt(view)).flatMap((unused, k, all) => (k % pyramidEnds === 0 ? facesOf(all.slice(k, k + pyramidEnds)) : []));
    this.group.add(lines, new Mesh(geometryOf(faces), this.materials.odd));
    this.points = points;
    this.paint = (Colour) => {
      const { color } = geometry.attributes;
      let next = 0;
      this.views.forEach((view, k) => {
        const { r, g, b } = new Colour(this.colourOf(view, k));
        for (let i = 0; i < counts[k]; ++i) color.setXYZ(next++, r, g, b);
      });
      color.needsUpdate = true;
    };
  }

  /** Those of the part itself are coloured as their dots. */
  colourOf({ kind, contradicts }, k) {
    if (contradicts) return colour('second');
    const other = kinds.slice(1).find(([key]) => key === kind);
    return other ? colour(other[2]) : this.colours(k);
  }

  addCurrent() {
    const { materials, size } = this;
    this.current = new Group();
    if (this.isCamera) {
      for (const camera of this.cameras) {
        const shape = cameraShape(camera, 0.075 * size, materials.now, materials.face);
        place(shape, camera.in_first);
        this.current.add(shape);
      }
    } else {
      this.current.add(boardShape(this.corners, materials.now, materials.dots));
    }
    this.group.add(this.current);
  }

  /** Moves what the flange carries; gives lines of sight, of a pose from each of `cameras` to the ends of the board. */
  show(worldFromFlange, cameras) {
    const at = multiply(worldFromFlange, this.onFlange);
    place(this.current, at);
    const board = edgesOf(this.corners).map((point) => apply(this.isCamera ? identity() : at, point));
    const seen = board.filter((point, k) => board.findIndex((other) => String(other) === String(point)) === k);
    return cameras.flatMap((k) => {
      const eye = apply(this.isCamera ? at : identity(), apply(this.cameras[k].in_first, [0, 0, 0]));
      return seen.flatMap((point) => [eye, point]);
    });
  }

  /** What is to be in view when only cameras and board are looked at. */
  extent() {
    const standing = this.isCamera ? edgesOf(this.corners) : this.cameras.map(({ in_first: inFirst }) => apply(inFirst, [0, 0, 0]));
    return [...standing, ...this.points];
  }

  recolour(Colour) {
    this.materials.stand.color.set(colour('ink'));
    this.materials.dots.color.set(colour('ink-soft'));
    this.materials.now.color.set(colour('ink'));
    this.materials.face.color.set(colour('accent'));
    this.materials.odd.color.set(colour('second'));
    this.paint(Colour);
  }
}
