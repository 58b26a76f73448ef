// Holds the lesson as WebAssembly to the digests that the native one is held to by tests/it/paper.rs.
//
// Usage: node tests/wasm/lesson.mjs, after `cargo xtask wasm lesson`.
import process from 'node:process';
import { accepted, golden, load } from './bundles.mjs';

const { Lesson } = await load('lesson');

/** Units of work per step: not the native test's number, which must make no difference. */
const BUDGET = 37;

const { runs } = await golden('lessons.json');
if (runs.length < 4) throw new Error(`only ${runs.length} runs`);
let failures = 0;
for (const { name, field, settings, events, half, digest } of runs) {
  const lesson = new Lesson();
  accepted(lesson.start(field, settings), name);
  while (!lesson.step(BUDGET).is_done);
  const found = { events: lesson.seek(0xffffffff), digest: lesson.digest(), half: '' };
  lesson.seek(Math.floor(events / 2));
  found.half = lesson.digest();
  const listed = lesson.events(0, 0xffffffff);
  const same = found.events === events && found.digest === digest && found.half === half && listed.length === events;
  failures += same ? 0 : 1;
  console.log(`${same ? 'same' : 'DIFFERENT'}  ${name}: ${JSON.stringify(found)}, ${listed.length} events listed`);
  lesson.free();
}

const lesson = new Lesson();
const [{ field }] = runs;
for (const [bad, settings, words] of [
  [field, { radius: 0.001 }, /20,000/],
  [{ ...field, formula: 'x^2 +' }, { radius: 0.1 }, /./],
  [field, { radius: 0.1, order: 'heap' }, /queue/],
]) {
  const answer = lesson.start(bad, settings);
  if (answer.ok || !words.test(answer.error.message)) throw new Error(`not refused: ${JSON.stringify(answer)}`);
}
if (lesson.step(1) !== null) throw new Error('a run that was refused goes on');
console.log('same  what cannot be followed is refused in words');
process.exitCode = failures > 0 ? 1 : 0;
