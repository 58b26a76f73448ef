/** Keeps the picture of a figure in view while a number that changes it is turned elsewhere in the text. */

/** Room around a pinned picture, in pixels. */
const MARGIN_PX = 8;

/** Ends what is pinned now. */
let unpin = () => {};

/**
 * Shows the picture of a figure in the larger room above or below a number, unless all of it is in view where it is. It
 * stays there until the number loses the focus, the page is scrolled, or Escape is pressed.
 * @param {HTMLElement} number  has the focus
 * @param {HTMLElement} stage  holds the figure
 */
export function pin(number, stage) {
  const shown = stage.querySelector('.picture, .drawing-box')?.getBoundingClientRect();
  if (stage.classList.contains('pinned') || !shown) return;
  const top = document.querySelector('.bar')?.getBoundingClientRect().bottom ?? 0;
  if (shown.top >= top && shown.bottom <= innerHeight) return;
  unpin();
  const own = number.getBoundingClientRect();
  const [above, below] = [own.top - top, innerHeight - own.bottom].map((room) => room - 2 * MARGIN_PX);
  const height = Math.min(shown.height, Math.max(above, below));
  const values = {
    '--pin-top': above > below ? top + MARGIN_PX : innerHeight - height - MARGIN_PX,
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
    stage.classList.remove('pinned');
  };
  number.addEventListener('blur', unpin, { signal });
  addEventListener('scroll', unpin, { signal });
  number.addEventListener('keydown', ({ key }) => key === 'Escape' && unpin(), { signal });
}
