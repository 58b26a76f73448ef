/** What a class needs and a reader alone does not: presenting, the hand-out, assignments and collecting. */
export { createMaker, mountAssignment } from './assignment.js';
export { mountCollect } from './collect.js';
export { createHandout } from './handout.js';
export { createPresenter } from './presenter.js';
export { unpackTask } from './task.js';
