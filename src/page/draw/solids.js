import {
  BoxGeometry,
  BufferGeometry,
  CapsuleGeometry,
  CylinderGeometry,
  DoubleSide,
  EdgesGeometry,
  Float32BufferAttribute,
  Group,
  LineBasicMaterial,
  LineSegments,
  Matrix4,
  Mesh,
  MeshLambertMaterial,
  PlaneGeometry,
  Quaternion,
  SphereGeometry,
  Vector3,
} from 'three';

const upright = new Vector3(0, 1, 0);

export const matrixOf = (rows) => new Matrix4().set(...rows);

/** Puts an object where the frame is; it does not move by itself. */
export function place(object, rows) {
  object.matrixAutoUpdate = false;
  object.matrix.copy(matrixOf(rows));
  object.matrixWorldNeedsUpdate = true;
}

/** Materials by what they are for; colours follow the theme. */
export function makeMaterials() {
  const solid = (options) => new MeshLambertMaterial(options);
  return {
    link: solid({}),
    joint: solid({}),
    instrument: solid({}),
    seen: solid({}),
    unseen: solid({}),
    obstacle: solid({ transparent: true, opacity: 0.55 }),
    wall: solid({ transparent: true, opacity: 0.12, side: DoubleSide, depthWrite: false }),
    edge: new LineBasicMaterial({}),
    faint: new LineBasicMaterial({ transparent: true, opacity: 0.5 }),
    sight: new LineBasicMaterial({}),
    way: new LineBasicMaterial({ transparent: true, opacity: 0.6 }),
  };
}

/** From one point to another, in the frame of the group it is in. */
export function capsule(from, to, radius, material) {
  const [a, b] = [new Vector3(...from), new Vector3(...to)];
  const length = a.distanceTo(b);
  const mesh = new Mesh(length > 1e-9 ? new CapsuleGeometry(radius, length, 8, 24) : new SphereGeometry(radius, 24, 16), material);
  mesh.position.copy(a).add(b).multiplyScalar(0.5);
  if (length > 1e-9) mesh.quaternion.copy(new Quaternion().setFromUnitVectors(upright, b.sub(a).normalize()));
  return mesh;
}

/** A rod of length 1 along y that `stretch` puts between two points. */
export const rod = (radius, material) => new Mesh(new CylinderGeometry(radius, radius, 1, 20), material);

export function stretch(mesh, from, to) {
  const [a, b] = [new Vector3(...from), new Vector3(...to)];
  const length = a.distanceTo(b);
  mesh.visible = length > 1e-6;
  mesh.position.copy(a).add(b).multiplyScalar(0.5);
  mesh.scale.set(1, Math.max(length, 1e-9), 1);
  if (mesh.visible) mesh.quaternion.setFromUnitVectors(upright, b.sub(a).normalize());
}

export const ball = (radius, material) => new Mesh(new SphereGeometry(radius, 20, 14), material);

/** A box about its centre: an obstacle, or edges alone. */
export function box({ size, world_from_box: rows, kind }, materials) {
  const group = new Group();
  const isObstacle = kind === 'keep_out';
  const geometry = new BoxGeometry(...size);
  if (isObstacle) group.add(new Mesh(geometry, materials.obstacle));
  group.add(new LineSegments(new EdgesGeometry(geometry), isObstacle ? materials.edge : materials.faint));
  place(group, rows);
  return group;
}

/** A square of the plane through `point`. */
export function wall({ normal }, centre, size, material) {
  const mesh = new Mesh(new PlaneGeometry(size, size), material);
  mesh.position.set(...centre);
  mesh.quaternion.setFromUnitVectors(new Vector3(0, 0, 1), new Vector3(...normal).normalize());
  return mesh;
}

export function lines(points, material) {
  const geometry = new BufferGeometry();
  geometry.setAttribute('position', new Float32BufferAttribute(points.flat(), 3));
  return new LineSegments(geometry, material);
}

/** Three coloured axes. */
export function axes(size) {
  const geometry = new BufferGeometry();
  geometry.setAttribute('position', new Float32BufferAttribute([0, 0, 0, size, 0, 0, 0, 0, 0, 0, size, 0, 0, 0, 0, 0, 0, size], 3));
  geometry.setAttribute(
    'color',
    new Float32BufferAttribute(
      [
        [0.85, 0.2, 0.2],
        [0.85, 0.2, 0.2],
        [0.2, 0.65, 0.2],
        [0.2, 0.65, 0.2],
        [0.25, 0.45, 0.95],
        [0.25, 0.45, 0.95],
      ].flat(),
      3,
    ),
  );
  return new LineSegments(geometry, new LineBasicMaterial({ vertexColors: true, depthTest: false }));
}
