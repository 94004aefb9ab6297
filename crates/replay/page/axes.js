// Axes of a curve over time, and the curve itself.

/** Curves of one plot that colours tell apart. */
const MOST_COLOURS = 8;

/** Writes a text where it is another one than before: what is written anew has to be laid out anew. */
function put(place, text) {
  if (place.textContent !== text) place.textContent = text;
}

/** Room for values from the least to the largest, with zero where it is near. */
function roomFor(low, high) {
  if (!(low <= high)) return [0, 1];
  if (low > 0 && low < 0.4 * high) low = 0;
  if (high < 0 && high > 0.4 * low) high = 0;
  if (high - low < 1e-12 * Math.max(Math.abs(high), Math.abs(low), 1e-12)) return [low - 0.5, high + 0.5];
  const margin = 0.04 * (high - low);
  return [low - (low === 0 ? 0 : margin), high + margin];
}

/** Draws the axes of a plot for values and times in these ranges, and tells where a value and a time [s] lie on it. */
function drawAxes(c, plot, colours, values, [start, end]) {
  const { width, height, density } = plot;
  c.setTransform(density, 0, 0, density, 0, 0);
  c.clearRect(0, 0, width, height);
  const [low, high] = roomFor(...values);
  const ticks = ticksBetween(low, high, Math.max(2, Math.floor(height / 40)));
  const size = Math.max(Math.abs(low), Math.abs(high));
  const exponent = plot.unit === '1' || plot.unit === '' ? 0 : 3 * Math.floor(Math.log10(size) / 3);
  const prefixed = /^[A-Z][a-z]?( m)?$/.test(plot.unit) && exponent in PREFIXES;
  const power = prefixed || exponent < -3 || exponent > 3 ? exponent : 0;
  const factor = 10 ** power;
  const unit = prefixed ? PREFIXES[exponent] + plot.unit : power ? `10${superscript(power)} ${plot.unit}` : plot.unit;
  put(plot.unitPlace, plot.unit === '1' || plot.unit === '' ? '' : ` [${unit}]`);
  c.font = '10.5px system-ui, "DejaVu Sans", sans-serif';
  const texts = ticks.map((tick) => withMinus(+(tick / factor).toPrecision(6)));
  // The widest number has room, sign included.
  const widest = Math.max(0, ...texts.map((text) => c.measureText(text).width));
  Object.assign(plot, { factor, left: Math.max(50, widest + 10), right: width - 12, top: 8, bottom: height - 20 });
  const y = (value) => plot.bottom - ((value - low) / (high - low)) * (plot.bottom - plot.top);
  const x = (time) => plot.left + ((time - start) / (end - start || 1)) * (plot.right - plot.left);
  c.fillStyle = colours.faint;
  c.strokeStyle = colours.line;
  c.lineWidth = 1;
  c.textAlign = 'right';
  c.textBaseline = 'middle';
  ticks.forEach((tick, i) => {
    const at = Math.round(y(tick)) + 0.5;
    c.beginPath();
    c.moveTo(plot.left, at);
    c.lineTo(plot.right, at);
    c.stroke();
    c.fillText(texts[i], plot.left - 6, at);
  });
  c.textBaseline = 'top';
  c.textAlign = 'center';
  const inMilliseconds = end - start < 0.5;
  for (const tick of ticksBetween(start, end, Math.max(2, Math.floor(width / 90)))) {
    const text = withMinus(+(tick * (inMilliseconds ? 1e3 : 1)).toPrecision(7));
    const half = 0.5 * c.measureText(text).width;
    c.fillText(text, Math.min(x(tick), plot.right - 14 - half), plot.bottom + 5);
  }
  c.textAlign = 'right';
  c.fillText(inMilliseconds ? 'ms' : 's', plot.right + 6, plot.bottom + 5);
  return { x, y };
}

/** A curve with its peaks: where many samples fall on one column of pixels, from the least to the largest of them. */
function tracePeaks(c, values, times, from, to, x, y) {
  let column = NaN;
  let [least, most, last] = [0, 0, 0];
  const close = () => {
    if (Number.isNaN(column)) return;
    c.lineTo(column, y(least));
    c.lineTo(column, y(most));
    c.lineTo(column, y(last));
  };
  let broken = true;
  for (let i = from; i <= to; i++) {
    const value = values[i];
    if (!Number.isFinite(value)) {
      close();
      [column, broken] = [NaN, true];
      continue;
    }
    const at = Math.round(2 * x(times[i])) / 2;
    if (at !== column) {
      close();
      if (broken) c.moveTo(at, y(value));
      broken = false;
      [column, least, most] = [at, value, value];
    }
    if (value < least) least = value;
    if (value > most) most = value;
    last = value;
  }
  close();
}

/** Round numbers between two ends, some `count` of them and never less than two: one alone tells no scale. */
function ticksBetween(low, high, count) {
  if (!(high > low)) return [];
  const share = (high - low) / count;
  const step = roundDown(share) * (share / roundDown(share) > 1.5 ? 2 : 1);
  const ticks = [];
  for (let i = Math.ceil(low / step); i * step <= high + 1e-9 * step; i++) ticks.push(i * step);
  return ticks.length > 1 ? ticks : ticksBetween(low, high, 1.5 * count);
}

/** A whole number as an exponent is written. */
function superscript(number) {
  return String(number).replace(/./g, (it) => (it === '-' ? '⁻' : '⁰¹²³⁴⁵⁶⁷⁸⁹'[it]));
}

/** The last frame that is not later than a moment. */
function frameBefore(times, moment) {
  let [low, high] = [0, times.length - 1];
  while (low < high) {
    const middle = (low + high + 1) >> 1;
    if (times[middle] <= moment) low = middle;
    else high = middle - 1;
  }
  return low;
}
