/** Which settings of the sampler are shown, where, and as what. Pure. */

/** @typedef {import('../../engine/types.js').SettingInfo} SettingInfo */
/** @typedef {import('../../engine/types.js').Settings} Settings */

/** The setting that decides which of the others there are: it stands at the head of the bar. */
const KIND = 'sampling';
const ADVANCED = 'Advanced';
/** As many letters in all fit side by side as a segmented control. */
const SEGMENTED_LETTERS = 24;

/** @param {SettingInfo[]} settings */
export function arrange(settings) {
  const rest = settings.filter(({ name }) => name !== KIND);
  return {
    kind: settings.find(({ name }) => name === KIND) ?? null,
    plain: rest.filter(({ group }) => group !== ADVANCED),
    advanced: rest.filter(({ group }) => group === ADVANCED),
  };
}

/** Two or three short values are easier to see side by side than in a list. @param {SettingInfo} info */
export function isSegmented({ kind, choices = [] }) {
  return (
    kind === 'choice' &&
    choices.length > 1 &&
    choices.length <= 3 &&
    choices.reduce((sum, { label }) => sum + label.length, 0) <= SEGMENTED_LETTERS
  );
}

/**
 * The value in force.
 * @param {SettingInfo[]} all
 * @param {Settings} values what differs from the defaults
 * @param {string} name
 */
export const settingValue = (all, values, name) => values[name] ?? all.find((info) => info.name === name)?.default;

/**
 * Whether every condition of a setting holds.
 * @param {SettingInfo} info
 * @param {SettingInfo[]} all
 * @param {Settings} values
 */
export function isShown({ when = [] }, all, values) {
  return when.every(({ name, value, equal = true }) => (settingValue(all, values, name) === value) === equal);
}

/**
 * How many of the shown settings were changed.
 * @param {SettingInfo[]} some
 * @param {SettingInfo[]} all
 * @param {Settings} values
 */
export function countChanged(some, all, values) {
  return some.filter((info) => isShown(info, all, values) && (values[info.name] ?? info.default) !== info.default)
    .length;
}
