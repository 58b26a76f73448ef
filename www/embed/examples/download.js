import { sample } from 'marching-particles';

document.getElementById('download')?.addEventListener('click', async () => {
  const cushion = await sample('x^4 + y^4 + z^4 = 1', { count: 5000, method: 'refined' });
  const { volume, faces } = await cushion.mesh();
  document.getElementById('facts')?.append(`${faces.length / 3} triangles, volume ${volume?.toFixed(3)}. `);
  const link = document.createElement('a');
  link.download = 'cushion.glb';
  link.href = URL.createObjectURL(new Blob([await cushion.toFile('glb')], { type: 'model/gltf-binary' }));
  link.click();
  URL.revokeObjectURL(link.href);
  cushion.dispose();
});
