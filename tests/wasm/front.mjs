// Holds the lesson's first view to the side of the seed, on every surface of the gallery.
//
// Usage: node tests/wasm/front.mjs, after `cargo xtask wasm core lesson`.
import process from 'node:process';
import { ballOf, fitDistance, viewOf } from '../../www/src/engine/view/camera.js';
import { anglesOf } from '../../www/src/engine/view/facing.js';
import { FIRST_LEVELS, frontNormal, shareFacing } from '../../www/src/learn/front.js';
import { load } from './bundles.mjs';

const [{ Core }, { Lesson }] = [await load('core'), await load('lesson')];

/** As many particles as the lesson's figures have. */
const COUNT = 1500;
/** The share of the discs of the first levels that faces the viewer. */
const WANTED = 0.9;
/** What is not seen although a direction shows it: one or two discs of some 60. */
const SLACK = 0.03;
/** Directions that are tried where so many cannot be seen, because the first levels reach around the surface. */
const TRIED = 2000;

const golden = Math.PI * (3 - Math.sqrt(5));
const directions = Array.from({ length: TRIED }, (_, k) => {
  const z = 1 - (2 * k + 1) / TRIED;
  const r = Math.sqrt(1 - z * z);
  return [r * Math.cos(golden * k), r * Math.sin(golden * k), z];
});

const core = new Core();
let [looked, failures, around] = [0, 0, 0];
for (const { id } of core.describe().surfaces) {
  const field = core.set_field({ surface: id });
  if (!field.ok || field.formula === '') continue;
  const { radius } = core.start({ size_mode: 'count', count: COUNT });
  const lesson = new Lesson();
  const surface = { formula: field.formula, parameters: field.parameters, bounds: field.bounds };
  const started = lesson.start(surface, { radius, matched: 'stay', relax_steps: 0 });
  if (!started.ok) throw new Error(`${id}: ${started.error.message}`);
  while (!lesson.step(500).is_done && lesson.chapters(0).length <= FIRST_LEVELS + 1);
  lesson.seek(0xffffffff);
  const particles = {
    positions: lesson.positions(),
    normals: lesson.normals(),
    levels: lesson.levels(),
    fronts: lesson.fronts(),
  };
  const ball = ballOf(field.bounds);
  const share = (normal) => {
    const camera = { target: ball.centre, distance: fitDistance(ball.radius), ...anglesOf(normal) };
    return shareFacing(particles, viewOf(camera, 1, 1, ball).eye, 1, FIRST_LEVELS);
  };
  const seen = share(frontNormal(particles, ball));
  looked += 1;
  if (seen < WANTED) {
    around += 1;
    const most = Math.max(...directions.map(share));
    const isBest = most < WANTED && seen >= most - SLACK;
    if (!isBest) failures += 1;
    console.log(
      `${isBest ? 'around' : 'HIDDEN'}  ${id}: ${seen.toFixed(3)} of the discs face the viewer, at most ${most.toFixed(3)}`,
    );
  }
  lesson.free();
}
console.log(`same  ${looked - around} of ${looked} surfaces show ${WANTED} of the first levels, ${around} bend around`);
if (looked < 30) throw new Error(`only ${looked} surfaces`);
process.exitCode = failures > 0 ? 1 : 0;
