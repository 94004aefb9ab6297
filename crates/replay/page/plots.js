// Quantities over time, with a cursor that goes with the picture.

/** Curves of one plot that colours tell apart. */
const MOST_COLOURS = 8;

class Plots {
  constructor(place, film, seek) {
    this.film = film;
    this.times = film.arrays.time.values;
    this.window = [this.times[0], this.times[film.frames - 1]];
    this.colours = palette();
    const channels = new Map();
    film.curves.forEach((curve) => {
      const known = channels.get(curve.channel) || { ...curve, curves: [] };
      const [unit, factor] = TRADE[curve.unit] ?? [curve.unit, 1];
      const values = film.arrays[curve.stream].column(curve.column).map((value) => factor * value);
      known.unit = unit;
      known.curves.push({ label: curve.label, values });
      channels.set(curve.channel, known);
    });
    this.plots = [...channels.values()].map((channel) => this.panel(place, channel, seek));
    place.hidden = this.plots.length === 0;
  }

  panel(place, channel, seek) {
    const section = document.createElement('section');
    section.className = 'plot';
    const heading = document.createElement('h2');
    heading.textContent = channel.name;
    const unit = document.createElement('span');
    heading.append(unit);
    const canvas = document.createElement('canvas');
    canvas.setAttribute('aria-label', `${channel.name} over time`);
    const key = document.createElement('div');
    key.className = 'key';
    const crowded = channel.curves.length > MOST_COLOURS;
    const named = channel.curves.filter(({ label }) => label !== '');
    if (crowded) key.textContent = `${named.length} curves; that of the roller followed, or its link, in colour`;
    else named.forEach(({ label }, i) => {
      const entry = document.createElement('span');
      entry.textContent = label;
      entry.style.setProperty('--own', `var(--curve-${i % MOST_COLOURS})`);
      key.append(entry);
    });
    section.append(heading, canvas, key);
    place.append(section);
    const plot = { ...channel, crowded, canvas, unitPlace: unit, drawn: document.createElement('canvas') };
    this.listen(plot, seek);
    return plot;
  }

  listen(plot, seek) {
    const { canvas } = plot;
    const moment = (event) => {
      const share = (event.offsetX - plot.left) / (plot.right - plot.left);
      return this.window[0] + Math.max(0, Math.min(1, share)) * (this.window[1] - this.window[0]);
    };
    canvas.addEventListener('pointerdown', (event) => {
      canvas.setPointerCapture(event.pointerId);
      seek(moment(event));
    });
    canvas.addEventListener('pointermove', (event) => {
      if (event.buttons) seek(moment(event));
    });
    canvas.addEventListener('wheel', (event) => {
      event.preventDefault();
      this.zoom(Math.exp(0.002 * event.deltaY), moment(event));
    }, { passive: false });
    canvas.addEventListener('dblclick', () => this.zoom(Infinity, 0));
  }

  /** Shows more or less time around a moment. */
  zoom(factor, moment) {
    const [first, last] = [this.times[0], this.times[this.film.frames - 1]];
    const least = (8 * (last - first)) / Math.max(8, this.film.frames);
    const length = Math.min(last - first, Math.max(least, factor * (this.window[1] - this.window[0])));
    const share = (moment - this.window[0]) / (this.window[1] - this.window[0] || 1);
    const start = Math.max(first, Math.min(last - length, moment - share * length));
    this.window = factor === Infinity ? [first, last] : [start, start + length];
    this.redraw();
    this.draw(this.frame);
  }

  /** Fits every canvas to its place and draws the curves; the cursor comes afterwards. */
  redraw() {
    this.colours = palette();
    const density = window.devicePixelRatio || 1;
    for (const plot of this.plots) {
      const { width, height } = plot.canvas.getBoundingClientRect();
      if (!width) continue;
      for (const canvas of [plot.canvas, plot.drawn]) {
        canvas.width = Math.round(width * density);
        canvas.height = Math.round(height * density);
      }
      Object.assign(plot, { width, height, density });
      this.drawCurves(plot);
    }
  }

  /** Frames inside the window, one more on either side. */
  shown() {
    const before = (moment) => frameBefore(this.times, moment);
    return [before(this.window[0]), Math.min(this.film.frames - 1, before(this.window[1]) + 1)];
  }

  drawCurves(plot) {
    const c = plot.drawn.getContext('2d');
    const { width, height, density } = plot;
    c.setTransform(density, 0, 0, density, 0, 0);
    c.clearRect(0, 0, width, height);
    const [from, to] = this.shown();
    let [low, high] = [Infinity, -Infinity];
    for (const { values } of plot.curves) {
      for (let i = from; i <= to; i++) {
        if (values[i] < low) low = values[i];
        if (values[i] > high) high = values[i];
      }
    }
    if (!(low <= high)) [low, high] = [0, 1];
    if (low > 0 && low < 0.4 * high) low = 0;
    if (high < 0 && high > 0.4 * low) high = 0;
    if (high - low < 1e-12 * Math.max(Math.abs(high), Math.abs(low), 1e-12)) [low, high] = [low - 0.5, high + 0.5];
    const margin = 0.04 * (high - low);
    [low, high] = [low - (low === 0 ? 0 : margin), high + margin];
    const ticks = ticksBetween(low, high, Math.max(2, Math.floor(height / 40)));
    const size = Math.max(Math.abs(low), Math.abs(high));
    const exponent = plot.unit === '1' || plot.unit === '' ? 0 : 3 * Math.floor(Math.log10(size) / 3);
    const prefixed = /^[A-Z][a-z]?( m)?$/.test(plot.unit) && exponent in PREFIXES;
    const power = prefixed || exponent < -3 || exponent > 3 ? exponent : 0;
    const factor = 10 ** power;
    const unit = prefixed ? PREFIXES[exponent] + plot.unit : power ? `10${superscript(power)} ${plot.unit}` : plot.unit;
    plot.unitPlace.textContent = plot.unit === '1' || plot.unit === '' ? '' : ` [${unit}]`;
    c.font = '10.5px system-ui, "DejaVu Sans", sans-serif';
    const texts = ticks.map((tick) => withMinus(+(tick / factor).toPrecision(6)));
    // The widest number has room, sign included.
    const widest = Math.max(0, ...texts.map((text) => c.measureText(text).width));
    Object.assign(plot, { left: Math.max(50, widest + 10), right: width - 12, top: 8, bottom: height - 20 });
    const y = (value) => plot.bottom - ((value - low) / (high - low)) * (plot.bottom - plot.top);
    const [start, end] = this.window;
    const x = (time) => plot.left + ((time - start) / (end - start || 1)) * (plot.right - plot.left);
    c.fillStyle = this.colours.faint;
    c.strokeStyle = this.colours.line;
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

    c.save();
    c.beginPath();
    c.rect(plot.left, 0, plot.right - plot.left, height);
    c.clip();
    c.lineWidth = 1.2;
    c.lineJoin = 'round';
    const trace = ({ values }, colour) => {
      c.strokeStyle = colour;
      c.beginPath();
      tracePeaks(c, values, this.times, from, to, x, y);
      c.stroke();
    };
    const { curves } = this.colours;
    if (plot.crowded) {
      c.globalAlpha = 0.25;
      for (const curve of plot.curves) trace(curve, this.colours.faint);
      c.globalAlpha = 1;
      const followed = plot.curves.find(({ label }) => label === String(this.followed));
      if (followed) trace(followed, curves[0]);
    } else plot.curves.forEach((curve, i) => trace(curve, curves[i % MOST_COLOURS]));
    c.restore();
  }

  /** Tells crowded plots apart the curve of a roller. */
  follow(roller) {
    this.followed = roller;
    for (const plot of this.plots) if (plot.crowded && plot.width) this.drawCurves(plot);
  }

  /** The curves as drawn before, and the cursor at a frame. */
  draw(frame) {
    this.frame = frame;
    for (const plot of this.plots) {
      if (!plot.width) continue;
      const c = plot.canvas.getContext('2d');
      c.setTransform(1, 0, 0, 1, 0, 0);
      c.clearRect(0, 0, plot.canvas.width, plot.canvas.height);
      c.drawImage(plot.drawn, 0, 0);
      const [start, end] = this.window;
      const share = (this.times[frame] - start) / (end - start || 1);
      if (share < 0 || share > 1) continue;
      c.setTransform(plot.density, 0, 0, plot.density, 0, 0);
      c.strokeStyle = this.colours.ink;
      c.lineWidth = 1;
      const at = Math.round(plot.left + share * (plot.right - plot.left)) + 0.5;
      c.beginPath();
      c.moveTo(at, plot.top);
      c.lineTo(at, plot.bottom);
      c.stroke();
    }
  }
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
