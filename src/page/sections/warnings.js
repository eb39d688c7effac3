import { mm, short } from '../core/format.js';

/** What the program warned of when it made a document; older ones do not say. */
export const warningsOf = (document) => (Array.isArray(document?.warnings) ? document.warnings.map(String) : []);

const list = (items, text) => items.map(text).join(', ');
const errorOf = (one) => (one.value_mm === undefined ? `${short(one.value_mrad, 3)} mrad` : `${mm(one.value_mm)} mm`);

/** Doubts that the program warns of: said only where its own sentences are not at hand. */
const warnedTexts = {
  misfit: (one) => `The nominal robot misses half of the points by at least ${short(one.distance_mm, 4)} mm.`,
  planes: (numbers) => `Stated otherwise than measured: plane ${numbers.join(', ')}.`,
  places: (places) => `Measured elsewhere than stated: ${list(places, (one) => one.what)}.`,
  gross_error_mm: (value) => `The nominal robot misses by ${short(value, 4)} mm: outliers, or a wrong robot?`,
  orientations: (one) => `The nominal robot misses the orientations by ${short(one.rms_deg, 3)} deg.`,
  sizes: (sizes) => `Far above the expected size: ${list(sizes, (one) => `${one.parameter} (${short(one.times_expected, 3)} times)`)}.`,
  model_errors: (errors) => `The model error found is large: ${list(errors, (one) => `${errorOf(one)}, ${short(one.times_expected, 3)} times what is expected`)}.`,
  scatter: (one) => `Repeats differ by ${short(one.ratio, 3)} times sigma${one.sample ? `; the farthest is ${one.sample}` : ''}.`,
  lacks_length: () => 'No distance is stated: nothing says how large everything is.',
  distance: (one) => `Socket ${one.socket} is stated ${short(one.stated_mm, 4)} mm from ${one.from}, measured at ${short(one.measured_mm, 4)} mm.`,
  held_back_size: (one) => `The size stated for ${one.key} is too small to be learned.`,
  workspace: (one) => `It is expected to miss poses of the workspace by ${errorOf({ value_mm: one.expected_mm, value_mrad: one.expected_mrad })}, more than twice what the nominal robot misses: too few poses.`,
  small_residuals: () => 'Residuals are far smaller than stated: sigma or model error in another unit?',
};

/** Doubts that the program prints beside its tables. */
const printedTexts = {
  residual_ratio: (ratio) => `Residuals are ${short(ratio, 2)} times what sigma and model error say.`,
  missing_errors: (part) => `About ${(100 * part).toFixed(0)} % of the squares left over follow the joints\u2019 positions: joints bend or have periodic errors that this model leaves out.`,
  negative_compliances: (joints) => `Negative compliance of ${joints.join(', ')}: is the sign of the torques right?`,
  residuals: (ratios) => list(ratios, (one) => printedTexts.residual_ratio(one.ratio)),
};

const movedTexts = {
  moved_before_validation: (moved) => `The validation was measured with another set-up: ${distancesOf(moved)} from where the calibration has it.`,
  moved_since_earlier: (moved) => `Measured with another set-up than the earlier estimate: ${distancesOf(moved)} from where that has it.`,
};
const distancesOf = (moved) => moved.parts.map((part) => `${part} ${short(moved[`${part}_mm`], 4)} mm`).join(' and ');

const textsOf = (texts, object) => Object.entries(texts).filter(([key]) => object?.[key]).map(([key, text]) => text(object[key]));

/** A doubt of a later version. */
const unknownTexts = (doubts) => Object.keys(doubts).filter((key) => !(key in warnedTexts || key in printedTexts)).map((key) => `${key.replaceAll('_', ' ')}: ${JSON.stringify(doubts[key])}.`);

/** All that is to be warned of with a calibration, in the program's words where it said them. */
export function warningsOfEstimate(document) {
  const said = warningsOf(document);
  const doubts = { ...document.doubts };
  if (doubts.residuals) delete doubts.residual_ratio;
  const faults = [document.faults ?? []].flat().map(String).filter((fault) => !said.some((text) => text.includes(fault)));
  const own = said.length > 0 ? [] : [...textsOf(warnedTexts, doubts), ...unknownTexts(doubts), ...textsOf(movedTexts, document.accuracy)];
  return [...faults, ...said, ...own, ...textsOf(printedTexts, doubts)];
}
