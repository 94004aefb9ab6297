// Curves that scroll, those of A in grey under them.

/** Lengths of the time shown [pitches]. */
const WINDOWS = [4, 12, 40, 120];

class Scrolls {
  constructor(place) {
    this.place = place;
    this.shown = WINDOWS[1];
    this.pointer = null;
    this.plots = [];
  }

  /** Plots for the curves of another drive; choices of the reader stay where curves are called alike. */
  open(history, facts) {
    Object.assign(this, { history, facts, kept: null, shift: 0, horizon: null });
    this.tellKept();
    const hidden = this.hidden ?? new Map();
    for (const curve of history.curves) {
      const key = `${curve.plot} ${curve.label}`;
      if (hidden.has(key)) curve.isShown = hidden.get(key);
    }
    this.hidden = hidden;
    const plots = Object.keys(PLOTS).filter((plot) => history.curves.some((it) => it.plot === plot));
    this.place.replaceChildren();
    this.plots = plots.map((plot) => this.panel(plot));
  }

  panel(name) {
    const section = document.createElement('section');
    section.className = 'plot';
    const heading = document.createElement('h2');
    const unitPlace = document.createElement('span');
    heading.append(PLOTS[name].name, unitPlace);
    const canvas = document.createElement('canvas');
    canvas.setAttribute('role', 'img');
    canvas.setAttribute('aria-label', `${PLOTS[name].name} over time`);
    const key = document.createElement('div');
    key.className = 'key';
    const curves = this.history.curves.map((curve, index) => ({ ...curve, curve, index })).filter((it) => it.plot === name);
    curves.forEach((entry, i) => {
      entry.colour = i % MOST_COLOURS;
      const button = document.createElement('button');
      button.type = 'button';
      button.title = 'Show or hide';
      button.style.setProperty('--own', `var(--curve-${entry.colour})`);
      const text = document.createElement('span');
      text.textContent = entry.label;
      entry.value = document.createElement('output');
      button.append(text, entry.value);
      const tell = () => button.setAttribute('aria-pressed', entry.curve.isShown);
      button.onclick = () => {
        entry.curve.isShown = !entry.curve.isShown;
        this.hidden.set(`${name} ${entry.label}`, entry.curve.isShown);
        tell();
        this.draw();
      };
      tell();
      if (curves.length > 1 || entry.label !== 'all') key.append(button);
    });
    section.append(heading, canvas, key);
    this.place.append(section);
    const plot = { name, unit: PLOTS[name].unit, unitPlace, canvas, curves };
    canvas.addEventListener('pointermove', (event) => {
      this.pointer = (event.offsetX - plot.left) / (plot.right - plot.left);
      this.draw();
    });
    canvas.addEventListener('pointerleave', () => {
      this.pointer = null;
      this.draw();
    });
    canvas.addEventListener('wheel', (event) => {
      if (!event.ctrlKey && !event.shiftKey) return;
      event.preventDefault();
      this.change(event.deltaY > 0 ? 1 : -1);
    }, { passive: false });
    return plot;
  }

  /** Shows more or less time. */
  change(places) {
    const at = WINDOWS.indexOf(this.shown) + places;
    this.shown = WINDOWS[Math.max(0, Math.min(WINDOWS.length - 1, at))];
    this.draw();
  }

  /** Time that is shown [s]. */
  get window() {
    const { facts, history } = this;
    const length = this.shown * (facts.mesh ?? IN_A_PITCH * history.every);
    return [Math.max(0, history.end - length), Math.max(history.end, length)];
  }

  /** Fits the canvases to their places. */
  resize() {
    const density = window.devicePixelRatio || 1;
    for (const plot of this.plots) {
      const { width, height } = plot.canvas.getBoundingClientRect();
      plot.width = width;
      if (!width) continue;
      const [wide, high] = [Math.round(width * density), Math.round(height * density)];
      // A canvas that gets a size is empty: only where it is another one.
      if (plot.canvas.width !== wide) plot.canvas.width = wide;
      if (plot.canvas.height !== high) plot.canvas.height = high;
      Object.assign(plot, { height, density });
    }
    this.draw();
  }

  /** Keeps curves as those of A; they stay at their own times as long as these are shown. */
  keep(history, what) {
    Object.assign(this, { kept: history, shift: 0, what });
    this.tellKept();
  }

  tellKept() {
    byId('kept').hidden = !this.kept;
    const pitches = this.facts.mesh ? Math.round(this.shift / this.facts.mesh) : 0;
    byId('kept-text').textContent = `In grey: ${this.what}${pitches ? `, ${pitches} pitches before` : ''}.`;
  }

  /** Lays A's last curves under the present ones where its own times have gone by: by whole pitches, so that teeth stand over teeth. */
  align([start, end]) {
    const { kept, facts } = this;
    if (!kept?.length || !facts.mesh) return;
    const isAway = kept.end + this.shift < start + 0.25 * (end - start);
    if (!isAway) return;
    this.shift = Math.ceil((end - kept.end) / facts.mesh) * facts.mesh;
    this.tellKept();
  }

  draw() {
    if (!this.history) return;
    const { history } = this;
    const range = this.window;
    this.align(range);
    const colours = palette();
    for (const plot of this.plots) if (plot.width) this.drawPlot(plot, range, colours);
    this.tellValues(range);
  }

  /** Values at the pointer, or now; these a few times a second only, which is as fast as they are read. */
  tellValues(range) {
    const { history } = this;
    const now = performance.now();
    if (this.pointer === null && now - (this.toldAt ?? 0) < 200) return;
    this.toldAt = now;
    const moment = this.pointer === null ? history.end : range[0] + this.pointer * (range[1] - range[0]);
    const at = Math.min(history.length - 1, history.before(moment));
    for (const { curves, factor = 1 } of this.plots) {
      for (const { index, value } of curves) {
        // In the unit of the axis.
        put(value, at >= 0 ? withMinus(short(history.series[index][at] / factor)) : '');
      }
    }
  }

  drawPlot(plot, range, colours) {
    const { history, kept, shift } = this;
    const [start, end] = range;
    const c = plot.canvas.getContext('2d');
    const shown = plot.curves.filter(({ curve }) => curve.isShown);
    const from = Math.max(0, history.before(start) - 1);
    const [keptFrom, keptTo] = kept ? [Math.max(0, kept.before(start - shift) - 1), kept.before(end - shift)] : [0, 0];
    let [low, high] = [Infinity, -Infinity];
    const widen = (series, first, last) => {
      for (let i = first; i < last; i++) {
        if (series[i] < low) low = series[i];
        if (series[i] > high) high = series[i];
      }
    };
    for (const { index } of shown) {
      widen(history.series[index], from, history.length);
      if (kept?.series[index]) widen(kept.series[index], keptFrom, keptTo);
    }
    const { x, y } = drawAxes(c, plot, colours, [low, high], range);
    c.save();
    c.beginPath();
    c.rect(plot.left, 0, plot.right - plot.left, plot.height);
    c.clip();
    c.lineJoin = 'round';
    this.drawHorizon(c, plot, x, colours);
    if (kept) {
      c.lineWidth = 1;
      c.strokeStyle = colours.faint;
      c.globalAlpha = 0.75;
      for (const { index } of shown) {
        if (!kept.series[index]) continue;
        c.beginPath();
        tracePeaks(c, kept.series[index], kept.times, keptFrom, keptTo - 1, (time) => x(time + shift), y);
        c.stroke();
      }
      c.globalAlpha = 1;
    }
    c.lineWidth = 1.2;
    for (const { index, colour } of shown) {
      c.strokeStyle = colours.curves[colour];
      c.beginPath();
      tracePeaks(c, history.series[index], history.times, from, history.length - 1, x, y);
      c.stroke();
    }
    if (this.pointer !== null) {
      const at = plot.left + this.pointer * (plot.right - plot.left);
      this.drawUpright(c, plot, at, colours.ink);
    }
    c.restore();
  }

  /** A line from the top to the bottom of a plot. */
  drawUpright(c, plot, at, colour) {
    c.strokeStyle = colour;
    c.lineWidth = 1;
    c.beginPath();
    c.moveTo(at, plot.top);
    c.lineTo(at, plot.bottom);
    c.stroke();
  }

  /** Where waveforms cease to be believed. */
  drawHorizon(c, plot, x, colours) {
    if (this.horizon === null) return;
    const at = Math.max(plot.left, x(this.horizon));
    if (at > plot.right) return;
    c.fillStyle = colours.faint;
    c.globalAlpha = 0.1;
    c.fillRect(at, plot.top, plot.right - at, plot.bottom - plot.top);
    c.globalAlpha = 1;
    c.setLineDash([4, 4]);
    this.drawUpright(c, plot, at, colours.faint);
    c.setLineDash([]);
  }
}

/** A number in four digits. */
function short(value) {
  if (!Number.isFinite(value)) return '–';
  const size = Math.abs(value);
  if (size >= 1e6 || (size > 0 && size < 1e-3)) return value.toExponential(2);
  return value.toFixed(size >= 1000 ? 0 : size >= 100 ? 1 : size >= 10 ? 2 : 3);
}
