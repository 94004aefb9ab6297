// Quantities over time, with a cursor that goes with the picture.

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
    const { height } = plot;
    const [from, to] = this.shown();
    let [low, high] = [Infinity, -Infinity];
    for (const { values } of plot.curves) {
      for (let i = from; i <= to; i++) {
        if (values[i] < low) low = values[i];
        if (values[i] > high) high = values[i];
      }
    }
    const { x, y } = drawAxes(c, plot, this.colours, [low, high], this.window);

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
