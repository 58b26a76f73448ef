/** Keeps the picture of a figure in view while a number that changes it is turned elsewhere in the text. */
import { queryAll } from '../ui/dom.js';

/** Room around a pinned picture, and the least height of one, in pixels. */
const MARGIN_PX = 8;
const LEAST_PX = 120;
/** After the last key a picture stays for so long. */
const STAYS_MS = 1500;

/** Ends what is pinned now. */
let unpin = () => {};
/** Ends a picture that keys have pinned. @type {ReturnType<typeof setTimeout> | undefined} */
let timer;

/**
 * The highest part of the window that holds none of some elements, as its upper and its lower end.
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
 * Shows the picture of a figure where neither the number that is turned nor a question stands, unless all of it is in
 * view where it is. It stays there until the number is let go, the page is scrolled, or Escape is pressed.
 * @param {HTMLElement} number  is turned
 * @param {HTMLElement} stage  holds the figure
 * @param {boolean} isDragged  or else turned by a key
 */
export function pin(number, stage, isDragged) {
  const shown = stage.querySelector('.picture, .drawing-box')?.getBoundingClientRect();
  const top = document.querySelector('.bar')?.getBoundingClientRect().bottom ?? 0;
  if (!stage.classList.contains('pinned')) {
    if (!shown || (shown.top >= top && shown.bottom <= innerHeight)) return;
    unpin();
    const [above, below] = freeRoom(top, [number, ...queryAll(document, '.predict')]);
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
    // What changes its height above is scrolled past by the browser itself, and leaves the number where it is.
    const { top: place } = number.getBoundingClientRect();
    const scrolled = () => Math.abs(number.getBoundingClientRect().top - place) > 1 && unpin();
    addEventListener('scroll', scrolled, { signal });
    number.addEventListener('keydown', ({ key }) => key === 'Escape' && unpin(), { signal });
  }
  clearTimeout(timer);
  if (!isDragged) timer = setTimeout(unpin, STAYS_MS);
}
