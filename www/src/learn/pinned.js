/** Keeps the picture of a figure in view while a number elsewhere in the text changes it. */
import { queryAll } from '../ui/dom.js';

/** Margin around a pinned picture, and its least height, in pixels. */
const MARGIN_PX = 8;
const LEAST_PX = 120;
/** Time for which a picture stays after the last key. */
const STAYS_MS = 1500;

/** Unpins the current picture. */
let unpin = () => {};
/** Unpins a picture that keys have pinned. @type {ReturnType<typeof setTimeout> | undefined} */
let timer;

/**
 * The tallest part of the window without any of these elements, as its upper and lower end.
 * @param {number} top @param {readonly Element[]} taken
 */
function freeRoom(top, taken) {
  const boxes = taken
    .map((one) => one.getBoundingClientRect())
    .filter((box) => box.bottom > top && box.top < innerHeight);
  boxes.sort((one, other) => one.top - other.top);
  let [best, from] = [[top, top], top];
  for (const { top: end, bottom } of [...boxes, { top: innerHeight, bottom: innerHeight }]) {
    if (end - from > best[1] - best[0]) best = [from, end];
    from = Math.max(from, bottom);
  }
  return best;
}

/**
 * Shows the picture of a figure away from the changing number, its paragraph and questions, unless it is all in view.
 * It stays until the number is released, the page is scrolled, or Escape is pressed.
 * @param {HTMLElement} number  the number that changes
 * @param {HTMLElement} stage  holds the figure
 * @param {boolean} isDragged  otherwise changed by a key
 */
export function pin(number, stage, isDragged) {
  const shown = stage.querySelector('.picture, .drawing-box')?.getBoundingClientRect();
  const top = document.querySelector('.bar')?.getBoundingClientRect().bottom ?? 0;
  if (!stage.classList.contains('pinned')) {
    if (!shown || (shown.top >= top && shown.bottom <= innerHeight)) return;
    unpin();
    const [above, below] = freeRoom(top, [number.closest('p') ?? number, ...queryAll(document, '.predict')]);
    const height = Math.min(shown.height, below - above - 2 * MARGIN_PX);
    if (height < LEAST_PX) return;
    const values = {
      '--pin-top': above + MARGIN_PX,
      '--pin-width': shown.width,
      '--pin-height': height,
      '--pin-place': shown.height,
    };
    for (const [name, px] of Object.entries(values)) stage.style.setProperty(name, `${px}px`);
    stage.classList.add('pinned');
    const end = new AbortController();
    const { signal } = end;
    unpin = () => {
      end.abort();
      clearTimeout(timer);
      stage.classList.remove('pinned');
    };
    for (const kind of ['blur', 'pointerup', 'pointercancel']) number.addEventListener(kind, unpin, { signal });
    // If content above changes its height, the browser scrolls by itself and the number stays in place.
    const { top: place } = number.getBoundingClientRect();
    const scrolled = () => Math.abs(number.getBoundingClientRect().top - place) > 1 && unpin();
    addEventListener('scroll', scrolled, { signal });
    number.addEventListener('keydown', ({ key }) => key === 'Escape' && unpin(), { signal });
  }
  clearTimeout(timer);
  if (!isDragged) timer = setTimeout(unpin, STAYS_MS);
}
