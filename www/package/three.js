/**
 * Samples as objects of three.js that use the arrays of the sample.
 *
 * @module
 */
import { BufferAttribute, BufferGeometry, InstancedMesh, Matrix4, Points, Quaternion, Vector3 } from 'three';

/** @import { Mesh, Sample } from './index.js' */

/** @param {Sample} sample */
function places({ points }) {
  // A graphics card takes no double precision.
  return new BufferAttribute(points instanceof Float32Array ? points : Float32Array.from(points), 3);
}

/**
 * Returns the particles with their normals, and the triangles if a mesh is given.
 * @param {Sample} sample @param {Mesh} [mesh]
 */
export function toBufferGeometry(sample, mesh) {
  const geometry = new BufferGeometry();
  geometry.setAttribute('position', places(sample));
  geometry.setAttribute('normal', new BufferAttribute(sample.normals, 3));
  if (mesh) geometry.setIndex(new BufferAttribute(mesh.faces, 1));
  return geometry;
}

/** @param {Sample} sample @param {import('three').Material} [material] */
export const toPoints = (sample, material) => new Points(toBufferGeometry(sample), material);

/**
 * Returns an instance of a geometry for each row: its z axis is the normal, and one unit of it is the radius.
 * @param {Sample} sample @param {import('three').BufferGeometry} geometry @param {import('three').Material} material
 */
export function toInstancedMesh({ points, normals, radii }, geometry, material) {
  // A particle on a crease has a row on each side.
  const count = radii.length;
  const mesh = new InstancedMesh(geometry, material, count);
  const matrix = new Matrix4();
  const z = new Vector3(0, 0, 1);
  const [place, normal, size, turn] = [new Vector3(), new Vector3(), new Vector3(), new Quaternion()];
  for (let i = 0; i < count; i += 1) {
    turn.setFromUnitVectors(z, normal.fromArray(normals, 3 * i));
    mesh.setMatrixAt(i, matrix.compose(place.fromArray(points, 3 * i), turn, size.setScalar(radii[i])));
  }
  return mesh;
}
