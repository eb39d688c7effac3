// Numbers as the program prints them.

/** `text` one unit of its last digit down: of a tie that was rounded up. */
function isTie(value, decimals) {
  // A tie is exact in binary, so that a few more digits show all of it.
  const digits = Math.abs(value).toFixed(Math.min(100, decimals + 30));
  const point = digits.indexOf('.');
  return point >= 0 && /^50*$/.test(digits.slice(point + 1 + decimals));
}

/** Like "%.*f", ties to even; "-" of what is not a number. */
export function fixed(value, decimals) {
  if (value === null || value === undefined || !Number.isFinite(value)) return '-';
  let text = value.toFixed(decimals);
  if (isTie(value, decimals)) {
    const last = text[text.length - 1];
    if (Number(last) % 2 === 1) {
      const unit = 10 ** -decimals;
      text = (value - (Math.sign(value) * unit) / 4).toFixed(decimals);
    }
  }
  return /[1-9]/.test(text) || text[0] !== '-' ? text : text.slice(1);
}

/** Like "%.*g". */
export function short(value, digits = 6) {
  if (value === null || value === undefined) return '-';
  if (!Number.isFinite(value)) return Number.isNaN(value) ? 'nan' : value > 0 ? 'inf' : '-inf';
  if (value === 0) return '0';
  const exponent = Number(value.toExponential(digits - 1).split('e')[1]);
  if (exponent >= -4 && exponent < digits) {
    const text = value.toFixed(Math.max(0, digits - 1 - exponent));
    return text.includes('.') ? text.replace(/\.?0+$/, '') : text;
  }
  const [mantissa, power] = value.toExponential(digits - 1).split('e');
  const trimmed = mantissa.includes('.') ? mantissa.replace(/\.?0+$/, '') : mantissa;
  const size = Math.abs(Number(power));
  return `${trimmed}e${power[0] === '-' ? '-' : '+'}${size < 10 ? '0' : ''}${size}`;
}

/** Millimetres or milliradians with four decimals. */
export const mm = (value) => fixed(value, 4);

/** The same of metres or radians. */
export const milli = (value) => (value === null || value === undefined ? '-' : fixed(1e3 * value, 4));

export const percent = (part, decimals = 0) => `${fixed(100 * part, decimals)} %`;

export const degrees = (radians) => (radians * 180) / Math.PI;

/** "1 pose", "2 poses". */
export const count = (number, one) => `${number} ${one}${number === 1 ? '' : 's'}`;

/** "q1_rad" taken apart. */
export function splitUnit(key) {
  const at = key.lastIndexOf('_');
  return { name: key.slice(0, at), unit: key.slice(at + 1) };
}

/** A joint's value as people read it, rad and m to deg and mm; others as they are. */
export function reading(key, value) {
  const { name, unit } = splitUnit(key);
  if (unit === 'rad') return { name, unit: 'deg', value: degrees(value) };
  if (unit === 'm') return { name, unit: 'mm', value: 1e3 * value };
  return { name, unit: unit === 'Nm' ? 'N m' : unit, value };
}
