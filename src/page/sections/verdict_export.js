import { count, mm, short } from '../core/format.js';
import { warningsOf } from './warnings.js';

/** What the files of an export can be trusted with. */
export function answerExport({ document }) {
  const { geometry, lost, not_exported: terms, read_back: files } = document;
  const most = Math.max(...files.map((one) => one.position_m));
  const rows = [['Files', files.map((one) => one.path).join(' ')], ['Geometry', geometry === 'nearest' ? 'that is nearest to the calibrated robot over the workspace' : 'as calibrated']];
  if (terms.length > 0) {
    rows.push(['Not in the files', `${terms.join(' ')}: they depend on the configuration`],
      ['Lost by that', `${mm(lost[geometry].rms_mm)} mm RMS, ${mm(lost[geometry].largest_mm)} mm at most; the robot that is not calibrated misses ${mm(lost.nominal.rms_mm)} mm RMS`]);
  }
  return { sentence: `${count(files.length, 'file')} written and read back: the flange is where it shall be within ${short(most, 2)} m.`, warnings: warningsOf(document), rows };
}
