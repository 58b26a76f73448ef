/** Small computed images for the gallery. */

/**
 * `parameters` are the initial choices for the image.
 * @typedef {{id: string, name: string, story: string, words: string, parameters: Record<string, number>}} Scan
 */

/** @type {readonly Scan[]} */
export const SCANS = [
  {
    id: 'scan-bone',
    name: 'Trabecular bone',
    story:
      'Struts as those inside a vertebra, on 64³ voxels with the noise of a scanner. The border of the image cuts them with a clean rim.',
    words: 'image volume ct scan trabeculae',
    parameters: { iso: 500 },
  },
  {
    id: 'scan-bodies',
    name: 'Two bodies',
    story:
      'A map of labels: each voxel belongs to the background, to a hollow body or to the ball in it. The boundary of a label is known to half a voxel, and a Gaussian rounds off its steps.',
    words: 'image volume label segmentation mask',
    parameters: { label: 1 },
  },
  {
    id: 'scan-benzene',
    name: 'Benzene density',
    story:
      'The density around twelve atoms, with noise: move the iso value, and the ring closes, joins its hydrogens and becomes a cloud.',
    words: 'image volume molecule cube orbital',
    parameters: { iso: 300 },
  },
  {
    id: 'scan-salt',
    name: 'Salt dome',
    story:
      'A body of salt among layers of rock, as a seismic survey shows it. A cutting plane shows the layers that it has lifted.',
    words: 'image volume seismic geology reservoir',
    parameters: { iso: 500 },
  },
];

/** @param {string} id */
export const scanOf = (id) => SCANS.find((scan) => scan.id === id);
