import { sample } from 'marching-particles';
import { toInstancedMesh } from 'marching-particles/three';
import { CircleGeometry, MeshStandardMaterial } from 'three';
import { show } from './stage.js';

const gyroid = await sample('sin(x) cos(y) + sin(y) cos(z) + sin(z) cos(x)', {
  spacing: 0.16,
  bounds: { min: [-3.2, -3.2, -3.2], max: [3.2, 3.2, 3.2] },
});
const disc = new CircleGeometry(0.92, 16);
show('gyroid', toInstancedMesh(gyroid, disc, new MeshStandardMaterial({ color: 0x5f9fc4, side: 2 })));
