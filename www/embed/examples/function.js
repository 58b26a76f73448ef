import { sample } from 'marching-particles';
import { toBufferGeometry } from 'marching-particles/three';
import { Mesh, MeshStandardMaterial } from 'three';
import { show } from './stage.js';

/** Six drops that run into each other. @param {number} x @param {number} y @param {number} z */
function drops(x, y, z) {
  let sum = 0;
  for (let i = 0; i < 6; i += 1)
    sum += 1 / ((x - Math.cos(1.1 * i)) ** 2 + (y - Math.sin(1.7 * i)) ** 2 + (z - 0.7 * Math.sin(2.3 * i)) ** 2);
  return 6 - sum;
}

const surface = await sample(drops, { count: 8000, method: 'refined' });
const geometry = toBufferGeometry(surface, await surface.mesh());
show('function', new Mesh(geometry, new MeshStandardMaterial({ color: 0xc9a45c })));
