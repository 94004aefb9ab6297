// Curves of the last while: samples come in, what is plotted is reckoned from them once.

/** Samples that are kept, at least. */
const KEPT = 16000;

/** Series over one clock, of which the oldest samples are forgotten. */
class History {
  /** `curves`: `{ plot, label, unit, value(row, history), isShown }`. */
  constructor(curves, every) {
    Object.assign(this, { curves, every, length: 0 });
    // Twice as long as what is kept: moved to the front only when it is full.
    this.times = new Float64Array(2 * KEPT);
    this.series = curves.map(() => new Float64Array(2 * KEPT));
    this.last = null;
  }

  push({ times, rows, width }) {
    for (let sample = 0; sample < times.length; sample++) {
      if (this.length === 2 * KEPT) this.forget();
      const row = rows.subarray(sample * width, (sample + 1) * width);
      this.times[this.length] = times[sample];
      this.curves.forEach((curve, i) => {
        this.series[i][this.length] = curve.value(row, this);
      });
      this.length += 1;
    }
    if (times.length) this.last = rows.slice((times.length - 1) * width);
  }

  forget() {
    for (const series of [this.times, ...this.series]) series.copyWithin(0, KEPT);
    this.length -= KEPT;
  }

  get begin() {
    return this.length ? this.times[0] : 0;
  }

  get end() {
    return this.length ? this.times[this.length - 1] : 0;
  }

  /** Number of samples before a time. */
  before(time) {
    let [low, high] = [0, this.length];
    while (low < high) {
      const middle = (low + high) >> 1;
      if (this.times[middle] < time) low = middle + 1;
      else high = middle;
    }
    return low;
  }

  /** Forgets what came after a time, as when one goes back to it. */
  cut(time) {
    this.length = this.before(time - 1e-9 * this.every);
  }

  /** The samples from a time on, as they are now. */
  copyFrom(time) {
    const from = this.before(time);
    const copy = Object.create(History.prototype);
    Object.assign(copy, { curves: this.curves, every: this.every, length: this.length - from, last: this.last });
    copy.times = this.times.slice(from, this.length);
    copy.series = this.series.map((series) => series.slice(from, this.length));
    return copy;
  }
}

/** Names of what a plot shows, with its unit and the text that explains it. */
const PLOTS = {
  tension: { name: 'Span tension', unit: 'N' },
  links: { name: 'Link tension', unit: 'N' },
  speed: { name: 'Speed', unit: 'rpm' },
  transmission: { name: 'Transmission error at the pitch circle', unit: 'µm' },
  tensioner: { name: 'Travel of the tensioner', unit: 'mm' },
  arm: { name: 'Angle of the tensioner', unit: '°' },
  losses: { name: 'Losses, mean over a pitch', unit: 'W' },
};

/** Curves of a drive, from the columns of its samples. */
function curvesOf(facts, started, every) {
  const found = started.labels.map((it, i) => ({ ...it, at: started.columns[i] }));
  const channel = (name) => found.find((it) => it.channel === name);
  const curves = [];
  const add = (plot, label, value, isShown = true) => curves.push({ plot, label, value, isShown });
  const entries = (name) => list(channel(name)?.labels).map((label, i) => [label, channel(name).at + i]);

  for (const [label, at] of entries('span_tension')) add('tension', label, (row) => row[at]);
  // A strand that hangs or swings: its ends and its middle.
  const links = entries('link_tension');
  for (const i of new Set([0, links.length >> 1, links.length - 1])) {
    if (links[i]) add('links', `link ${links[i][0]}`, (row) => row[links[i][1]]);
  }
  const sprocket = (name) => facts.sprockets.find((it) => it.name === name);
  // Shown at first: what is loaded, not idlers, which turn at speeds of their own.
  const isLoaded = (it) => list(it?.shaft?.load).length + list(it?.shaft?.drive).length > 0;
  const anyLoaded = facts.sprockets.some(isLoaded);
  for (const [label, at] of entries('sprocket_speed')) {
    add('speed', label, (row) => row[at] * RPM, isLoaded(sprocket(label)) || !anyLoaded);
  }
  const angles = new Map(entries('sprocket_angle'));
  for (const { pitch, stops } of facts.layout) {
    const members = stops.map((it) => sprocket(it.name)).filter(Boolean);
    const first = members.includes(facts.driver) ? facts.driver : members[0];
    for (const driven of members.filter((it) => it !== first)) {
      // ε = (s_b z_b θ_b − s_a z_a θ_a) p/2π
      const [from, at] = [angles.get(first.name), angles.get(driven.name)];
      const [a, b] = [first.sign * first.teeth, driven.sign * driven.teeth];
      const scale = (1e6 * pitch) / (2 * Math.PI);
      add('transmission', `${driven.name} after ${first.name}`, (row) => (b * row[at] - a * row[from]) * scale, isLoaded(driven));
    }
  }
  // Of several at least one is shown.
  const errors = curves.filter((it) => it.plot === 'transmission');
  if (errors.length && !errors.some((it) => it.isShown)) errors[0].isShown = true;
  const arms = channel('tensioner_position');
  entries('tensioner_position').forEach(([label, at], i) => {
    const isArm = unitsOf(arms)[i] === 'rad';
    add(isArm ? 'arm' : 'tensioner', label, (row) => row[at] * (isArm ? 180 / Math.PI : 1e3));
  });
  const lost = channel('energy_dissipated').at;
  const span = Math.max(1, Math.round((facts.mesh ?? IN_A_PITCH * every) / every));
  const kept = new Float64Array(span);
  let count = 0;
  let clock = NaN;
  add('losses', 'all', (row, history) => {
    // After a jump in time the mean begins anew.
    const now = history.times[history.length];
    if (!(Math.abs(now - clock - every) < 0.01 * every)) count = 0;
    clock = now;
    const place = count % span;
    const power = count < span ? NaN : (row[lost] - kept[place]) / (span * every);
    kept[place] = row[lost];
    count += 1;
    return power;
  });
  return { curves, channel };
}

/** Units of the entries of a channel, one each. */
function unitsOf({ unit, labels }) {
  const units = unit.split(', ');
  return list(labels).map((_, i) => units[i] ?? units[0]);
}
