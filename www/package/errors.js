/** The errors of the package. Each has a name of its own and says what to do. @module */

class NamedError extends Error {
  /** @param {string} message @param {{cause?: unknown}} [facts] */
  constructor(message, { cause } = {}) {
    super(message, cause === undefined ? undefined : { cause });
    this.name = new.target.name;
  }
}
/** An argument or an option is not what it has to be. */
export class InputError extends NamedError {}
/** The formula has a mistake between `start` and `end`, in UTF-16 code units. */
export class FormulaError extends NamedError {
  /**
   * @param {string} message
   * @param {{start?: number, end?: number, suggestion?: string | null, choices?: string[]}} [facts]
   */
  constructor(message, { start = 0, end = 0, suggestion = null, choices = [] } = {}) {
    super(message);
    this.start = start;
    this.end = end;
    this.suggestion = suggestion;
    this.choices = choices;
  }
}
/** The function that is sampled threw, which is the `cause`, or returned something else than its values. */
export class FieldError extends NamedError {}
/** No particle could be placed. */
export class NoSurfaceError extends NamedError {}
/** The sample was disposed of, or its particles have moved on with another one. */
export class DisposedError extends NamedError {}
/** The worker has not started, or it has failed. The next sampling starts another one. */
export class WorkerError extends NamedError {}

const CLASSES = { InputError, FormulaError, FieldError, NoSurfaceError, DisposedError, WorkerError };

/**
 * The error that a worker tells of.
 * @param {{name: string, message: string, facts: object}} words
 */
export function errorOf({ name, message, facts }) {
  const Class = CLASSES[/** @type {keyof typeof CLASSES} */ (name)] ?? WorkerError;
  // A single letter is a name, such as that of f.
  const text = message.replace(/^[a-z](?=[a-z])/, (letter) => letter.toUpperCase());
  return new Class(/[.?!]$/.test(text) ? text : `${text}.`, facts);
}
