/** Parts that only a class needs: questions on paper, assignments and collecting. */
export { createMaker, mountAssignment } from './assignment.js';
export { mountCollect } from './collect.js';
export { printQuestions } from './paper.js';
export { unpackTask } from './task.js';
