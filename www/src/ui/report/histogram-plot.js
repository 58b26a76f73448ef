/** Draws the histogram. This module is loaded with the first report. */
import uPlot from 'uplot';
import { formatSignificant } from '../format.js';

/** @param {string} name */
const token = (name) => {
  // A canvas does not resolve light-dark(), so an element does.
  const probe = document.createElement('span');
  probe.style.color = `var(${name})`;
  document.body.append(probe);
  const { color } = getComputedStyle(probe);
  probe.remove();
  return color;
};

/** @type {WeakMap<HTMLElement, { plot: uPlot, colours: string, observer: ResizeObserver }>} */
const plots = new WeakMap();

/**
 * @param {HTMLElement} host
 * @param {{ min: number, max: number, bins: number[] }} histogram
 */
export function drawHistogram(host, { min, max, bins }) {
  const width = (max - min) / bins.length;
  const xs = bins.map((_, i) => min + (i + 0.5) * width);
  const [ink, line, accent] = [token('--ink-2'), token('--line'), token('--accent')];
  const colours = [ink, line, accent].join();
  const old = plots.get(host);
  if (old && old.colours === colours) {
    old.plot.setData([xs, bins], true);
    return;
  }
  old?.observer.disconnect();
  old?.plot.destroy();
  const font = `${Math.round(parseFloat(getComputedStyle(host).fontSize))}px ${getComputedStyle(host).fontFamily}`;
  const plot = new uPlot(
    {
      width: Math.max(host.clientWidth, 50),
      height: Math.max(host.clientHeight, 50),
      padding: [6, 8, 0, 8],
      legend: { show: false },
      cursor: { show: false },
      scales: { x: { time: false }, y: { range: (_, __, high) => [0, Math.max(1, high) * 1.05] } },
      axes: [
        {
          stroke: ink,
          font,
          size: 22,
          gap: 3,
          space: 44,
          grid: { show: false },
          ticks: { stroke: line, width: 1, size: 4 },
          values: (_, splits) => splits.map((value) => formatSignificant(value, 3)),
        },
        { show: false },
      ],
      series: [
        {},
        { paths: uPlot.paths.bars?.({ size: [1, Infinity], gap: 1 }), fill: accent, width: 0, points: { show: false } },
      ],
      hooks: { drawAxes: [(u) => drawIdeal(u, ink)] },
    },
    [xs, bins],
    host,
  );
  const observer = new ResizeObserver(() => {
    if (host.clientWidth > 0) plot.setSize({ width: host.clientWidth, height: host.clientHeight });
  });
  observer.observe(host);
  plots.set(host, { plot, colours, observer });
}

/** Draws a dashed line at the spacing of the perfect hexagonal lattice. @param {uPlot} u @param {string} stroke */
function drawIdeal(u, stroke) {
  const x = Math.round(u.valToPos(1, 'x', true));
  const { left, top, width, height } = u.bbox;
  if (x < left || x > left + width) return;
  u.ctx.save();
  u.ctx.strokeStyle = stroke;
  u.ctx.setLineDash([3, 3]);
  u.ctx.beginPath();
  u.ctx.moveTo(x, top);
  u.ctx.lineTo(x, top + height);
  u.ctx.stroke();
  u.ctx.restore();
}
