/** The search on the circle and Newton's method, side by side in the plane of one slot. */
import { asideWords, lens, profileOf } from '../../figures/drawings.js';
import { momentAt } from '../../figures/moment.js';
import { openParticle } from '../../figures/particle.js';
import { inRadii, tell } from '../../figures/words.js';
import { fill, h, live } from '../../ui/dom.js';
import { formatCount, MISSING } from '../../ui/format.js';
import { NoSurface } from '../lab.js';
import { sharpestBend } from '../measure.js';
import { createRange, facts } from '../parts.js';

/** @import { Context, Lab } from '../types.js' */

/**
 * Opens the particle around which the surface bends most, at the slot of the child beyond the bend.
 * @param {Lab} lab
 */
export async function openBend(lab) {
  const run = await lab.coarse();
  const bend = sharpestBend(run.placed);
  if (!bend) throw new NoSurface('The surface holds one particle only, which has no children.');
  const opened = await openParticle(run.client, run, bend.parent);
  const whole = momentAt(opened.events, opened.events.length - 1);
  const slot = whole.children.find(({ particle, fate }) => particle === bend.child && fate === 'added')?.slot ?? 1;
  return { run, opened, whole, slot, profile: opened.profiles[slot] };
}

/** @param {Context} context */
export async function circle({ lab, stops }) {
  const { opened, slot, profile } = await openBend(await lab);
  const { events, subject } = opened;
  if (!profile) throw new NoSurface('Here the slot holds the parent.');
  const own = events.flatMap((event, at) =>
    'slot' in event && event.slot === slot && ['slot', 'iterate', 'landed'].includes(event.type) ? [at] : [],
  );
  const box = h('div', { class: 'drawing-box' });
  const side = h('div', { class: 'side' });
  const told = h('p', { class: 'told', 'aria-live': 'polite' });
  const range = createRange({
    name: 'Step',
    max: own.length - 1,
    value: own.length - 1,
    say: (at) => `${formatCount(at + 1)} of ${formatCount(own.length)}`,
    change: () => show(),
  });
  function show() {
    const moment = momentAt(events, own[range.get()]);
    const child = moment.children[slot];
    const isOpen = stops.isOpen('predict-newton');
    const shown = isOpen && profile ? profile : profile && { ...profile, newton: [] };
    if (!shown) return;
    told.textContent = tell(moment, subject);
    fill(box, profileOf(opened, { ...shown, newtonDistance: isOpen ? shown.newtonDistance : null }, child));
    const enlarged = isOpen ? lens(opened, shown, child) : null;
    const newton =
      shown.newtonDistance === null ? 'no landing' : inRadii(shown.newtonDistance, subject.radius) + asideWords(shown);
    fill(
      side,
      told,
      facts([
        ['Circle lands at', child.landed ? inRadii(child.landed.distance, subject.radius) : MISSING],
        ['Newton lands at', isOpen && child.landed ? newton : MISSING],
        ['Wanted', inRadii(2 * subject.radius, subject.radius)],
      ]),
      h('div', { class: 'controls' }, range.element),
      enlarged
        ? h('div', { class: 'lens-box' }, enlarged, h('p', { class: 'figure-count' }, 'The landings, enlarged'))
        : null,
    );
  }
  live(box, show);
  return [h('div', { class: 'two' }, box, side)];
}
