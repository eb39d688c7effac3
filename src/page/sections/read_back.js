import { lead } from '../core/figure.js';
import { mm, short } from '../core/format.js';
import { el } from '../core/dom.js';
import { table } from '../core/table.js';

export const title = 'Exported files read back';

export const isShown = (part) => part.document.read_back?.length > 0;

export function render(part) {
  return el(
    'div',
    {},
    lead('Each file written was read again, and its flange compared with what it shall say.'),
    part.document.not_exported?.length > 0
      ? table(
          'Lost without the errors that depend on the configuration, at the targets over the workspace',
          ['geometry', 'RMS/mm', 'largest/mm'],
          [
            ['nominal', 'not calibrated'],
            ['nearest', 'nearest'],
            ['estimate', 'estimate'],
          ]
            .filter(([key]) => part.document.lost[key])
            .map(([key, name]) => [name, mm(part.document.lost[key].rms_mm), mm(part.document.lost[key].largest_mm)]),
        )
      : null,
    table(
      'Largest difference of the flange',
      ['file', 'configurations', 'position/m', 'orientation/rad'],
      part.document.read_back.map((one) => [one.path, String(one.configurations), short(one.position_m, 2), short(one.orientation_rad, 2)]),
    ),
  );
}
