/** The button that makes a mesh, and opens the panel with the verdict on it. The panel comes with the first press. */
import { button } from '../button.js';
import { h, live, query } from '../dom.js';
import { explain, place } from '../explain.js';
import { loadSheet } from '../sheet.js';
import sheet from './mesh.css?url';

/**
 * @import { Engine } from '../../engine/types.js'
 * @import { Toast } from '../types.js'
 */

/** @param {Engine} engine @param {Toast} toast */
export function createMeshButton(engine, toast) {
  /** @type {Promise<HTMLElement> | null} */
  let panel = null;
  const load = async () => {
    const [{ createMeshPanel }] = await Promise.all([import('./panel.js'), loadSheet(sheet)]);
    const close = () => {
      holder.hidePopover();
      element.focus();
    };
    // It stays open while the picture is turned.
    const holder = h('div', { class: 'menu', popover: 'manual' }, createMeshPanel(engine, { toast, close }));
    holder.addEventListener('keydown', (event) => {
      if (event.key !== 'Escape') return;
      event.stopPropagation();
      close();
    });
    document.body.append(holder);
    // A mesh is of no use beside a formula with a mistake. The caret stays in the formula.
    live(holder, () => {
      if (engine.fieldError.value) holder.hidePopover();
    });
    return holder;
  };
  const open = async () => {
    engine.makeMesh();
    panel ??= load();
    try {
      const holder = await panel;
      if (!holder.matches(':popover-open')) holder.showPopover();
      // Its right end is that of the button, so that it does not reach over the report, and it is above the levels.
      const { right, top, bottom } = element.getBoundingClientRect();
      const levels = query(document, '.panel-levels').getBoundingClientRect();
      const from = levels.height > 0 ? Math.min(top, levels.top) : top;
      place(holder, new DOMRect(right - holder.offsetWidth, from, holder.offsetWidth, bottom - from), 'above');
      query(holder, '.save').focus();
    } catch {
      panel = null;
      toast({ id: 'save', kind: 'error', text: 'A part of the page could not be loaded. Load it again.' });
    }
  };
  const text = 'Samples by the refined method, joins the particles to triangles, checks them, and saves them.';
  const element = explain(button({ press: () => void open() }, 'Make a mesh'), () => ({ text }), { side: 'above' });
  return { element, open };
}
