// Numbers as people read them, rounded as the tool's own table rounds them.

/** Three significant digits, without trailing zeros. */
function significant(value) {
  if (value === 0 || !Number.isFinite(value)) return String(value);
  return String(Number(value.toPrecision(3)));
}

export const bytes = (count) => Math.round(count).toLocaleString('en-US');
export const percent = (fraction) => `${significant(fraction * 100)}%`;
export const length = (metres) => (Math.abs(metres) < 1 ? `${significant(metres * 1000)} mm` : `${significant(metres)} m`);
export const seconds = (value) => `${value.toFixed(2)} s`;
export const degrees = (value) => `${significant(value)}°`;
export const number = (value) => value.toLocaleString('en-US');

export function ratio(before, after) {
  if (!(before > 0) || !(after > 0)) return '–';
  return `${(before / after).toFixed(1)}×`;
}

/** A size with a unit, for headlines. */
export function size(count) {
  if (count < 1000) return `${count} B`;
  if (count < 1e6) return `${significant(count / 1000)} kB`;
  return `${significant(count / 1e6)} MB`;
}
