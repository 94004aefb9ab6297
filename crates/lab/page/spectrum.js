// The spectrum of a curve, with the orders at which teeth mesh.

/** Samples of a spectrum, at most. */
const MOST_SAMPLES = 8192;

/** Fourier transform in place of a number of values that is a power of two (Cooley and Tukey). */
function transform(re, im) {
  const n = re.length;
  for (let i = 1, j = 0; i < n; i++) {
    let bit = n >> 1;
    for (; j & bit; bit >>= 1) j ^= bit;
    j ^= bit;
    if (i < j) {
      [re[i], re[j]] = [re[j], re[i]];
      [im[i], im[j]] = [im[j], im[i]];
    }
  }
  for (let length = 2; length <= n; length <<= 1) {
    const half = length >> 1;
    for (let k = 0; k < half; k++) {
      const [cos, sin] = [Math.cos((2 * Math.PI * k) / length), -Math.sin((2 * Math.PI * k) / length)];
      for (let i = k; i < n; i += length) {
        const j = i + half;
        const [x, y] = [re[j] * cos - im[j] * sin, re[j] * sin + im[j] * cos];
        [re[j], im[j]] = [re[i] - x, im[i] - y];
        re[i] += x;
        im[i] += y;
      }
    }
  }
}

/** Amplitudes of a series, in its unit, by a Hann window; the mean is taken off. */
function amplitudes(values, every) {
  const n = values.length;
  const mean = values.reduce((sum, it) => sum + it, 0) / n;
  const re = Float64Array.from(values, (it, i) => (it - mean) * 0.5 * (1 - Math.cos((2 * Math.PI * i) / n)));
  const im = new Float64Array(n);
  transform(re, im);
  // The window halves a sine: A = 2 · 2 |X| / n.
  const found = Float64Array.from({ length: n >> 1 }, (_, i) => (4 / n) * Math.hypot(re[i], im[i]));
  return { found, step: 1 / (n * every) };
}

class Spectrum {
  constructor(canvas, choice, note) {
    Object.assign(this, { canvas, choice, note, unitPlace: byId('spectrum-unit') });
    choice.onchange = () => this.draw();
  }

  open(history, facts) {
    Object.assign(this, { history, facts });
    const before = this.choice.value;
    this.choice.replaceChildren();
    history.curves.forEach(({ plot, label }, i) => {
      this.choice.add(new Option(label === 'all' ? PLOTS[plot].name : `${PLOTS[plot].name}: ${label}`, `${i}`));
    });
    if (before < history.curves.length) this.choice.value = before || '0';
  }

  /** The last samples without a gap, a power of two of them. */
  samples(index) {
    const { history } = this;
    const series = history.series[index].subarray(0, history.length);
    let sound = 0;
    while (sound < series.length && Number.isFinite(series[series.length - 1 - sound])) sound += 1;
    const n = 2 ** Math.floor(Math.log2(Math.min(sound, MOST_SAMPLES)));
    return n >= 128 ? series.subarray(series.length - n) : null;
  }

  /** Frequency at which teeth of the driving sprocket met the chain during the last samples [Hz]; none where nothing drives. */
  meshFrequency(count) {
    const { history, facts: { driver } } = this;
    const turned = history.curves.findIndex((it) => it.plot === 'speed' && it.label === driver?.name);
    if (turned < 0) return null;
    const speeds = history.series[turned].subarray(history.length - count, history.length);
    const mean = speeds.reduce((sum, it) => sum + it, 0) / count;
    return (driver.teeth * Math.abs(mean)) / 60 || null;
  }

  draw() {
    if (!this.history) return;
    const { canvas } = this;
    const { width, height } = canvas.getBoundingClientRect();
    if (!width) return;
    const density = window.devicePixelRatio || 1;
    canvas.width = Math.round(width * density);
    canvas.height = Math.round(height * density);
    const c = canvas.getContext('2d');
    c.setTransform(density, 0, 0, density, 0, 0);
    const colours = palette();
    const index = Number(this.choice.value);
    const curve = this.history.curves[index];
    const values = curve && this.samples(index);
    this.unitPlace.textContent = curve ? ` [${PLOTS[curve.plot].unit}]` : '';
    if (!values) {
      this.note.textContent = 'A spectrum needs 128 samples: some three pitches.';
      return;
    }
    const { found, step } = amplitudes(values, this.history.every);
    const mesh = this.meshFrequency(values.length);
    const end = mesh ? Math.min(step * found.length, 12.5 * mesh) : step * found.length;
    const last = Math.min(found.length, Math.ceil(end / step));
    let most = 0;
    for (let i = 2; i < last; i++) most = Math.max(most, found[i]);
    // Three and a half decades below the largest line nothing is seen of a drive but rounding.
    const top = Math.log10(most || 1) + 0.1;
    const low = top - 3.6;
    const [left, right, upper, lower] = [54, width - 12, 10, height - 34];
    const x = (frequency) => left + (frequency / end) * (right - left);
    const y = (value) => lower - Math.max(0, (Math.log10(value || 1e-300) - low) / (top - low)) * (lower - upper);
    c.font = '10.5px system-ui, "DejaVu Sans", sans-serif';
    c.fillStyle = colours.faint;
    c.strokeStyle = colours.line;
    c.lineWidth = 1;
    c.textAlign = 'right';
    c.textBaseline = 'middle';
    for (let power = Math.ceil(low); power <= top; power++) {
      const at = Math.round(y(10 ** power)) + 0.5;
      c.beginPath();
      c.moveTo(left, at);
      c.lineTo(right, at);
      c.stroke();
      c.fillText(power < -3 || power > 5 ? `10${superscript(power)}` : withMinus(+(10 ** power).toPrecision(1)), left - 6, at);
    }
    c.textBaseline = 'top';
    c.textAlign = 'center';
    for (const tick of ticksBetween(0, end, Math.max(2, Math.floor(width / 90)))) {
      c.fillText(+tick.toPrecision(6), x(tick), lower + 18);
    }
    c.textAlign = 'right';
    c.fillText('Hz', right + 8, lower + 18);
    if (mesh) {
      c.strokeStyle = colours.accent;
      c.fillStyle = colours.accent;
      c.textAlign = 'center';
      const teeth = this.facts.driver.teeth;
      for (let order = 1; order * mesh < end; order++) {
        c.globalAlpha = 0.35;
        c.beginPath();
        c.moveTo(x(order * mesh), upper);
        c.lineTo(x(order * mesh), lower);
        c.stroke();
        c.globalAlpha = 1;
        if ((right - left) * (mesh / end) > 26 || order % 2) c.fillText(`${order * teeth}`, x(order * mesh), lower + 4);
      }
    }
    c.save();
    c.beginPath();
    c.rect(left, upper, right - left, lower - upper);
    c.clip();
    c.strokeStyle = colours.curves[0];
    c.lineWidth = 1.2;
    c.lineJoin = 'round';
    c.beginPath();
    for (let i = 1; i < last; i++) {
      if (i === 1) c.moveTo(x(i * step), y(found[i]));
      else c.lineTo(x(i * step), y(found[i]));
    }
    c.stroke();
    c.restore();
    const orders = mesh ? ` Blue lines: mesh orders of ${this.facts.driver.name}, z n with z = ${this.facts.driver.teeth}.` : '';
    this.note.textContent = `Amplitudes of the last ${quantity(values.length * this.history.every, 's')}, Hann window, `
      + `a line every ${quantity(step, 'Hz')}.${orders}`;
  }
}
