/** The icons, as strokes on a 16 × 16 grid. */

const PATHS = /** @type {const} */ ({
  plus: 'M8 3.500v9M3.500 8h9',
  minus: 'M3.500 8h9',
  fit: 'M2.500 5.500v-3h3M10.500 2.500h3v3M13.500 10.500v3h-3M5.500 13.500h-3v-3M8 6.200a1.800 1.800 0 1 1 0 3.600a1.800 1.800 0 0 1 0-3.600',
  left: 'M13 8H3.500M7.200 4.300 3.500 8l3.700 3.700',
  right: 'M3 8h9.500M8.800 4.300 12.500 8l-3.700 3.700',
  up: 'M8 13V3.500M4.300 7.200 8 3.500l3.700 3.700',
  down: 'M8 3v9.500M4.300 8.800 8 12.500l3.700-3.700',
  fold: 'M4 9.800 8 6l4 3.800',
  unfold: 'M4 6.200 8 10l4-3.800',
  close: 'M4 4l8 8M12 4l-8 8',
  help: 'M5.800 6.100a2.200 2.200 0 1 1 3.300 1.900c-.7.400-1.100.8-1.100 1.600M8 11.900v.1',
  link: 'M6.800 9.200a2.400 2.400 0 0 0 3.400 0l2.600-2.600a2.400 2.400 0 0 0-3.400-3.400l-.9.9M9.200 6.800a2.400 2.400 0 0 0-3.400 0L3.200 9.400a2.400 2.400 0 0 0 3.400 3.400l.9-.9',
  picture: 'M2.500 3.500h11v9h-11zM2.500 10.500l3-3 3.500 4M8.200 10.500l2-2 3.300 3M10.500 5.800v.1',
  undo: 'M5.500 2.800 2.500 5.800l3 3M2.800 5.800h6.400a4 4 0 0 1 0 8H6.500',
  redo: 'M10.500 2.800l3 3-3 3M13.200 5.800H6.800a4 4 0 0 0 0 8h2.700',
  points:
    'M4 4.200v.1M8 3v.1M12 4.600v.1M3 8.300v.1M6.500 7.600v.1M10.200 8.400v.1M13.300 9.200v.1M4.700 12.200v.1M8.400 12.900v.1M11.600 12.500v.1',
  file: 'M4 2.500h5l3 3v8H4zM9 2.500v3h3',
  first: 'M4.500 4v8M11.500 4 7.500 8l4 4',
  back: 'M9.800 4 5.800 8l4 4',
  forward: 'M6.200 4l4 4-4 4',
  last: 'M11.500 4v8M4.500 4l4 4-4 4',
  follow:
    'M8 5.900a2.100 2.100 0 1 1 0 4.200a2.100 2.100 0 0 1 0-4.200M8 1.800v1.600M8 12.600v1.600M2.600 4.900 4 5.700M12 10.300l1.400.8M2.600 11.100 4 10.300M12 5.700l1.400-.8',
  charts: 'M3 13V8.500M6.300 13V4M9.700 13V7M13 13v-3.500',
  save: 'M8 2.500v7.500M4.800 7.100 8 10.200l3.200-3.100M3 13.200h10',
  play: 'M5 3.500v9l7.500-4.500z',
  pause: 'M5.500 4v8M10.500 4v8',
  turntable:
    'M13.500 8c0 1.400-2.500 2.500-5.500 2.500S2.500 9.400 2.500 8 5 5.500 8 5.500c1.500 0 2.800.3 3.800.7M12.500 3.800l-.5 2.600-2.600-.2',
  options:
    'M2.500 5h5.200M11.300 5h2.200M2.500 11h2.200M8.300 11h5.200M9.500 3.200a1.800 1.800 0 1 1 0 3.600a1.800 1.800 0 0 1 0-3.600M6.500 9.200a1.800 1.800 0 1 1 0 3.600a1.800 1.800 0 0 1 0-3.600',
});

/** @typedef {keyof typeof PATHS} IconName */

/**
 * Creates a decorative icon. The element that contains it carries the accessible name.
 * @param {IconName} name
 */
export const icon = (name) => drawIcon(PATHS[name]);

/** @param {string} shape  a path on the same grid */
function drawIcon(shape) {
  const svg = document.createElementNS('http://www.w3.org/2000/svg', 'svg');
  svg.setAttribute('viewBox', '0 0 16 16');
  svg.setAttribute('aria-hidden', 'true');
  svg.setAttribute('class', 'icon');
  const path = document.createElementNS('http://www.w3.org/2000/svg', 'path');
  path.setAttribute('d', shape);
  svg.append(path);
  return svg;
}
