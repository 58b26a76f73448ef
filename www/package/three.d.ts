import type { BufferGeometry, InstancedMesh, Material, Points } from 'three';
import type { Mesh, Sample } from './index.js';

/** The particles with their normals, and the triangles if a mesh is given. */
export function toBufferGeometry(sample: Sample, mesh?: Mesh): BufferGeometry;
export function toPoints(sample: Sample, material?: Material): Points;
/** An instance per particle: the z axis of the geometry is the normal, and one unit of it is the radius. */
export function toInstancedMesh(sample: Sample, geometry: BufferGeometry, material: Material): InstancedMesh;
