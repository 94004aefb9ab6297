// Colours: those of the page follow the theme, tension has a scale of its own.

/** Steps of the scale: more cannot be told apart. */
const STEPS = 48;

// From slack to tight, dark enough on white and light enough on black.
const SCALES = {
  light: ['#7fa9cf', '#3f7cb8', '#5b5ea6', '#a3447f', '#d8473f', '#f08c00'],
  dark: ['#3c5a80', '#4a8fd0', '#8d86d8', '#d070a8', '#f0705c', '#ffc04d'],
};

const channels = (colour) => [1, 3, 5].map((at) => parseInt(colour.slice(at, at + 2), 16));

/** The scale of a theme as `STEPS` colours. */
function scaleOf(theme) {
  const stops = SCALES[theme].map(channels);
  return Array.from({ length: STEPS }, (_, step) => {
    const place = (step / (STEPS - 1)) * (stops.length - 1);
    const left = Math.min(Math.floor(place), stops.length - 2);
    const mixed = stops[left].map((c, i) => Math.round(c + (place - left) * (stops[left + 1][i] - c)));
    return `rgb(${mixed.join(' ')})`;
  });
}

/** Colours of the style sheet, by their names there, and the scale of tension. */
function palette() {
  const style = getComputedStyle(document.documentElement);
  const read = (name) => style.getPropertyValue(`--${name}`).trim();
  const theme = read('theme');
  const names = ['paper', 'ink', 'faint', 'line', 'steel', 'steel-line', 'guide', 'arm', 'arm-line',
    'plate', 'plate-line', 'roller', 'force', 'accent'];
  const colours = Object.fromEntries(names.map((name) => [name, read(name)]));
  const curves = Array.from({ length: 8 }, (_, i) => read(`curve-${i}`));
  return { ...colours, theme, curves, scale: scaleOf(theme) };
}

// Numbers as engineers write them: three digits and a prefix.
const PREFIXES = { '-9': 'n', '-6': 'µ', '-3': 'm', 0: '', 3: 'k', 6: 'M', 9: 'G' };

/** A number with a minus that is one. */
const withMinus = (text) => String(text).replaceAll('-', '−');

/** A value with its unit; units that take no prefix are written out. */
function quantity(value, unit, digits = 3) {
  if (!Number.isFinite(value)) return '–';
  if (unit === '1' || unit === '') return withMinus(+value.toPrecision(digits));
  const plain = /^[A-Za-z]+( m)?(\/s)?$/.test(unit) && unit !== 'rad' && unit !== 'rad/s';
  if (!plain || value === 0) return `${withMinus(+value.toPrecision(digits))} ${unit}`;
  const exponent = Math.max(-9, Math.min(9, 3 * Math.floor(Math.log10(Math.abs(value) * 1.0005) / 3)));
  return `${withMinus(+(value / 10 ** exponent).toPrecision(digits))} ${PREFIXES[exponent]}${unit}`;
}

/** Units that engineers read instead of those of SI, and how many of them one is. */
const TRADE = { rad: ['°', 180 / Math.PI], 'rad/s': ['rpm', 30 / Math.PI], m: ['mm', 1e3] };

/** The largest of 1, 2, 5 times a power of ten that is no larger. */
function roundDown(value) {
  const power = 10 ** Math.floor(Math.log10(value));
  return [5, 2, 1].find((step) => step * power <= value * 1.0001) * power;
}
