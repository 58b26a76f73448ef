/** What a class needs and a reader alone does not: questions on paper, assignments and collecting. */
export { createMaker, mountAssignment } from './assignment.js';
export { mountCollect } from './collect.js';
export { printQuestions } from './paper.js';
export { unpackTask } from './task.js';
