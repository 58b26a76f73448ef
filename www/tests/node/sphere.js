/**
 * Returns a PLY file of points with normals on a sphere.
 * @param {number} count @param {number} [radius]
 */
export function spherePly(count, radius = 1) {
  const rows = Array.from({ length: count }, (_, i) => {
    const z = 1 - (2 * i + 1) / count;
    const s = Math.sqrt(1 - z * z);
    const turn = i * Math.PI * (3 - Math.sqrt(5));
    const normal = [s * Math.cos(turn), s * Math.sin(turn), z];
    return [...normal.map((v) => v * radius), ...normal].map((v) => v.toFixed(6)).join(' ');
  });
  const names = ['x', 'y', 'z', 'nx', 'ny', 'nz'].map((name) => `property float ${name}`);
  return ['ply', 'format ascii 1.0', `element vertex ${count}`, ...names, 'end_header', ...rows, ''].join('\n');
}
