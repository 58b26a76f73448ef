// Types of the shareable state.

/**
 * An option. `valid` returns the valid value that is nearest to any input, or undefined. With `exact` a value that had
 * to be changed counts as one that was reset.
 */
export type Option<T> = { home: () => T; words: string; valid: (raw: unknown) => T | undefined; exact?: boolean };
