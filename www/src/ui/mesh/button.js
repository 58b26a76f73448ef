/** The button that makes a mesh and opens the panel with the verdict. The panel is loaded on the first press. */
import { untracked } from '@preact/signals-core';
import { button } from '../button.js';
import { h, live, query } from '../dom.js';
import { explain, place } from '../explain.js';
import { loadSheet } from '../sheet.js';
import sheet from './mesh.css?url';

/**
 * @import { Engine } from '../../engine/types.js'
 * @import { Print, Toast } from '../types.js'
 */

/** Room that is left above the panel. */
const MARGIN_PX = 8;

/** @param {Engine} engine @param {Toast} toast @param {Print} print */
export function createMeshButton(engine, toast, print) {
  /** @type {Promise<HTMLElement> | null} */
  let panel = null;
  const methodOf = () => engine.state.value.settings.method;
  /** The method at the time of opening. @type {ReturnType<typeof methodOf>} */
  let method;
  const load = async () => {
    const [{ createMeshPanel }] = await Promise.all([import('./panel.js'), loadSheet(sheet)]);
    const close = () => {
      holder.hidePopover();
      element.focus();
    };
    // It stays open while the picture is turned.
    const holder = h(
      'div',
      { class: 'menu mesh-holder', popover: 'manual' },
      createMeshPanel(engine, { toast, close, print }),
    );
    holder.addEventListener('keydown', (event) => {
      if (event.key !== 'Escape') return;
      event.stopPropagation();
      close();
    });
    // `beforetoggle` is sent at once, so the mesh is never seen without its panel.
    holder.addEventListener('beforetoggle', ({ newState }) => {
      if (newState === 'closed') untracked(engine.leaveMesh);
    });
    document.body.append(holder);
    // A mesh is of no use while the formula has an error; the caret stays in the formula. Choosing another method
    // closes the panel, so that its effect is seen.
    live(holder, () => {
      if (engine.fieldError.value || methodOf() !== method) holder.hidePopover();
    });
    return holder;
  };
  const open = async () => {
    method = untracked(methodOf);
    engine.makeMesh();
    panel ??= load();
    try {
      const holder = await panel;
      Object.assign(holder.style, { bottom: '', maxHeight: '' });
      if (!holder.matches(':popover-open')) holder.showPopover();
      // Its right end is aligned with the button, so that it does not cover the report, and it is above the levels.
      const { right, top, bottom } = element.getBoundingClientRect();
      const levels = query(document, '.panel-levels').getBoundingClientRect();
      const from = levels.height > 0 ? Math.min(top, levels.top) : top;
      place(holder, new DOMRect(right - holder.offsetWidth, from, holder.offsetWidth, bottom - from), 'above');
      // Its lower end stays fixed when its content grows.
      const end = holder.getBoundingClientRect().bottom;
      Object.assign(holder.style, { top: 'auto', bottom: `${innerHeight - end}px`, maxHeight: `${end - MARGIN_PX}px` });
      query(holder, '.save').focus();
    } catch {
      panel = null;
      toast({ id: 'save', kind: 'error', text: 'A part of the page could not be loaded. Load it again.' });
    }
  };
  const text = 'Resamples, triangulates and checks the surface, ready to save.';
  const element = explain(button({ press: () => void open() }, 'Make a mesh'), () => ({ text }), { side: 'above' });
  return { element, open };
}
