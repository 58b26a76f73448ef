/** Decides which settings are shown, where, and with which control, and whether the Run button is highlighted. */
import { computed } from '@preact/signals-core';

/** @import { Engine, SettingInfo, Settings } from '../../engine/types.js' */

/** The setting on which the others depend. It is shown first. */
const KIND = 'sampling';
const ADVANCED = 'Advanced';
/** The group of settings that are shown with the clip box. */
const BOX = 'Box';
/** Largest number of letters in a segmented control. */
const SEGMENTED_LETTERS = 24;

/** Whether a setting is behind the Advanced button; the box of a formula needs room. @param {SettingInfo} info */
const isAdvanced = ({ group, kind }) => group === ADVANCED || kind === 'text';

/** @param {SettingInfo[]} settings */
export function arrange(settings) {
  const rest = settings.filter(({ name, group }) => name !== KIND && group !== BOX);
  return {
    kind: settings.find(({ name }) => name === KIND) ?? null,
    plain: rest.filter((info) => !isAdvanced(info)),
    advanced: rest.filter(isAdvanced),
  };
}

/**
 * Returns whether a choice has two or three short values, which are shown as a segmented control.
 * @param {SettingInfo} info
 */
export function isSegmented({ kind, choices = [] }) {
  return (
    kind === 'choice' &&
    choices.length > 1 &&
    choices.length <= 3 &&
    choices.reduce((sum, { label }) => sum + label.length, 0) <= SEGMENTED_LETTERS
  );
}

/**
 * Returns the effective value of a setting.
 * @param {SettingInfo[]} all
 * @param {Settings} values values that differ from the defaults
 * @param {string} name
 */
const settingValue = (all, values, name) => values[name] ?? all.find((info) => info.name === name)?.default;

/**
 * Returns whether all conditions of a setting hold. Grading has an effect wherever sizes change, also by the spacing.
 * @param {SettingInfo} info
 * @param {SettingInfo[]} all
 * @param {Settings} values
 */
export function isShown({ name, when = [] }, all, values) {
  if (name === 'grading' && (values.spacing || values.brush)) return true;
  return when.every((one) => (settingValue(all, values, one.name) === one.value) === (one.equal ?? true));
}

/**
 * Counts the visible settings that were changed.
 * @param {SettingInfo[]} some
 * @param {SettingInfo[]} all
 * @param {Settings} values
 */
export function countChanged(some, all, values) {
  return some.filter((info) => isShown(info, all, values) && (values[info.name] ?? info.default) !== info.default)
    .length;
}

/**
 * Returns whether a run would change the picture: it does not show all of the present input. Otherwise *Run* is not
 * highlighted, because changes are sampled automatically.
 * @param {Engine} engine
 */
export const isDue = ({ trial, result, report, status, progress }) =>
  computed(() => {
    const isWhole = report.value !== null || result.value === 'none';
    const rests = status.value !== 'sampling' && progress.value.phase === 'done';
    return trial.value === 'typing' || result.value === 'partial' || (rests && !isWhole);
  });
