/** Opens a file that is dropped anywhere on the page, and shows a hint while a file is dragged over it. */
import { h } from '../dom.js';
import { carriesFiles, filesOf, IMAGE_FORMATS, MESH_FORMATS, ofFiles } from './files.js';

/**
 * @import { Engine } from '../../engine/types.js'
 * @import { Toast } from '../types.js'
 */

/**
 * @param {Engine} engine
 * @param {Toast} toast
 */
export function mountDrop(engine, toast) {
  const target = h(
    'div',
    { class: 'drop', role: 'status', hidden: true },
    h(
      'div',
      { class: 'drop-text' },
      h('strong', null, 'Drop to sample its surface'),
      h('span', { class: 'quiet' }, `A mesh: ${MESH_FORMATS}`),
      h('span', { class: 'quiet' }, () => `Points: ${filesOf(engine)}`),
      h('span', { class: 'quiet' }, `An image: ${IMAGE_FORMATS}`),
    ),
  );
  document.body.append(target);
  const show = (/** @type {boolean} */ on) => {
    target.hidden = !on;
  };

  addEventListener('dragenter', (event) => {
    if (carriesFiles(event.dataTransfer)) show(true);
  });
  addEventListener('dragover', (event) => {
    if (!carriesFiles(event.dataTransfer)) return;
    // Otherwise the browser would leave the page and show the file.
    event.preventDefault();
    if (event.dataTransfer) event.dataTransfer.dropEffect = 'copy';
    show(true);
  });
  // The hint disappears only when the drag leaves the window, not when it moves between elements.
  addEventListener('dragleave', (event) => {
    if (event.relatedTarget === null) show(false);
  });
  addEventListener('dragend', () => show(false));
  addEventListener(
    'drop',
    (event) => {
      show(false);
      const { dataTransfer } = event;
      if (!dataTransfer || !carriesFiles(dataTransfer)) return;
      event.preventDefault();
      // Otherwise the formula editor would insert the file as text.
      event.stopPropagation();
      const { file, beside } = ofFiles([...dataTransfer.files]);
      if (!file) return;
      // The voxels of an image may be in a file of their own.
      if (beside.length > 1 || (beside.length === 1 && !/\.(hdr|nhdr|mhd)$/i.test(file.name)))
        toast({ id: 'files', kind: 'info', text: `One file makes one surface: ${file.name} was taken.` });
      void engine.openFile(file, beside);
    },
    true,
  );
}
