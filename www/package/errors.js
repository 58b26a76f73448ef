/** The errors of the package. Each has its own name and says what to do. @module */

class NamedError extends Error {
  /** @param {string} message @param {{cause?: unknown}} [facts] */
  constructor(message, { cause } = {}) {
    super(message, cause === undefined ? undefined : { cause });
    this.name = new.target.name;
  }
}
/** An argument or an option is not valid. */
export class InputError extends NamedError {}
/** The formula is wrong between `start` and `end`, in UTF-16 code units. */
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
/** The sampled function threw the `cause`, or did not return its values. */
export class FieldError extends NamedError {}
/** No particle could be placed. */
export class NoSurfaceError extends NamedError {}
/** The sample was disposed of, or its particles have moved to another sample. */
export class DisposedError extends NamedError {}
/** The worker did not start, or failed. The next sampling starts a new one. */
export class WorkerError extends NamedError {}

const CLASSES = { InputError, FormulaError, FieldError, NoSurfaceError, DisposedError, WorkerError };

/**
 * Turns an error that a worker reported into an `Error`.
 * @param {{name: string, message: string, facts: object}} words
 */
export function errorOf({ name, message, facts }) {
  const Class = CLASSES[/** @type {keyof typeof CLASSES} */ (name)] ?? WorkerError;
  // A single letter is a name, such as f.
  const text = message.replace(/^[a-z](?=[a-z])/, (letter) => letter.toUpperCase());
  return new Class(/[.?!]$/.test(text) ? text : `${text}.`, facts);
}
