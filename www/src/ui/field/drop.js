/** A file dropped anywhere on the page becomes a surface; while one is dragged over it, the page says so. */
import { h } from '../dom.js';
import { carriesFiles, FORMATS, LIMIT, listOf } from './files.js';

/**
 * @param {import('../../engine/types.js').Engine} engine
 * @param {import('../toasts.js').Toast} toast
 */
export function mountDrop(engine, toast) {
  const target = h(
    'div',
    { class: 'drop', role: 'status', hidden: true },
    h(
      'div',
      { class: 'drop-text' },
      h('strong', null, 'Drop to sample its surface'),
      h('span', { class: 'quiet' }, `${listOf(FORMATS)}, up to ${LIMIT}`),
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
    // Without this the browser would leave the page and show the file.
    event.preventDefault();
    if (event.dataTransfer) event.dataTransfer.dropEffect = 'copy';
    show(true);
  });
  // The drag left the window, and not only one element for the next.
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
      // The formula's editor would take the file for text.
      event.stopPropagation();
      const [file, ...others] = dataTransfer.files;
      if (!file) return;
      if (others.length > 0)
        toast({ id: 'files', kind: 'info', text: `One file makes one surface: ${file.name} was taken.` });
      void engine.openFile(file);
    },
    true,
  );
}
