/** A program with an engine of its own, which the compiler checks against the declarations that are given to others. */
import { createEngine } from '../../../target/declarations/engine/index.js';

const engine = createEngine({ host: document.body, state: { formula: 'x^2 + y^2 + z^2 = 1' } });
const count: number = engine.progress.value.particles;
// @ts-expect-error the number of particles is not a text
const text: string = engine.progress.value.particles;
engine.destroy();

export { count, text };
