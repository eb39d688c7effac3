import { count, mm, short } from '../core/format.js';

/** What the files of an export can be trusted with. */
export function answerExport({ geometry, lost, not_exported: terms, read_back: files }) {
  const most = Math.max(...files.map((one) => one.position_m));
  const answers = [
    { text: `${count(files.length, 'file')} written and read back: the flange is where it should be within ${short(most, 2)} m` },
    { question: 'Files', text: files.map((one) => one.path).join(' ') },
    { question: 'Geometry', text: geometry === 'nearest' ? 'nearest to the calibrated robot over the workspace' : 'as calibrated' },
  ];
  if (terms.length > 0) {
    answers.push(
      { question: 'Not in the files', text: `${terms.join(' ')}: they depend on the configuration` },
      {
        question: 'Lost by that',
        text: `${mm(lost[geometry].rms_mm)} mm RMS, ${mm(lost[geometry].largest_mm)} mm at most; the robot that is not calibrated misses ${mm(lost.nominal.rms_mm)} mm RMS`,
      },
    );
  }
  return answers;
}
