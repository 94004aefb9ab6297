// What can be changed: some things while the drive moves, others with a start anew.

/** A range for a slider: from zero to a multiple of a value. */
const upTo = (value, times, otherwise) => (value < 0 ? [times * value, 0] : [0, value > 0 ? times * value : otherwise]);

/** Inputs that act at once: `{ key, label, unit, factor, range, start, set(value) → questions for the worker }`, values in SI; `inScene(value)` are `[path, value]` where a scene can say the same. */
function liveInputs(facts) {
  const { scene, shafts, sprockets, mesh, tunables } = facts;
  const inputs = [];
  // Along a ramp over two pitches: a jump would strike the chain.
  const over = 2 * (mesh ?? 0);
  for (const shaft of shafts) {
    const speed = meanSpeed(shaft.motion);
    if (speed === null) continue;
    const sense = speed < 0 ? 'clockwise' : 'counter-clockwise';
    inputs.push({
      group: 'Speed and load', key: `speed ${shaft.name}`, label: `speed of ${shaft.name}`, hint: `${sense}; evenly, without orders that the scene adds`,
      unit: 'rpm', factor: RPM, range: upTo(Math.abs(speed), 2), start: Math.abs(speed),
      set: (value) => [['set', { kind: 'speed', name: shaft.name, value: Math.sign(speed) * value, over }]],
      inScene: shaft.motion.kind === 'constant' ? (value) => [[`${shaft.place}.motion.speed`, Math.sign(speed) * value]] : null,
    });
  }
  for (const shaft of shafts.filter((it) => tunables.includes(`${it.place}.load`))) {
    const mean = Math.abs(meanTorque(list(shaft.load)));
    // A load that does not change is a torque; others are set as parts of what the scene has.
    const isEven = mean > 0 && list(shaft.load).every((it) => it.kind === 'constant');
    const whole = mean ? `that of the scene, ${quantity(mean, 'N m')} in the mean` : 'that of the scene';
    inputs.push({
      group: 'Speed and load', key: `load ${shaft.name}`, label: `load of ${shaft.name}`, hint: isEven ? '' : `in parts of ${whole}`,
      unit: isEven ? 'N m' : '×', factor: isEven ? mean : 1, range: [0, 3], start: 1,
      set: (value) => [['set', { kind: 'parameter', name: `${shaft.place}.load`, value }]],
      inScene: isEven ? (value) => list(shaft.load).map((it, i) => [`${shaft.place}.load[${i}].torque`, value * it.torque]) : null,
    });
  }
  for (const shaft of shafts.filter((it) => !it.motion && (list(it.drive).length || !facts.driver))) {
    const size = Math.abs(meanTorque([...list(shaft.drive), ...list(shaft.load)])) || 10;
    inputs.push({
      group: 'Speed and load', key: `torque ${shaft.name}`, label: `torque added on ${shaft.name}`, hint: 'counter-clockwise positive',
      unit: 'N m', factor: 1, range: [-2 * size, 2 * size], start: 0,
      set: (value) => [['set', { kind: 'torque', name: shaft.name, value, over }]],
    });
  }
  for (const tensioner of list(scene.tensioners)) {
    const { name, push, carrier } = tensioner;
    if (!push || push.kind === 'locked') continue;
    const turns = carrier.kind === 'arm';
    if (['spring', 'torsion-spring'].includes(push.kind)) {
      const moment = push.kind === 'torsion-spring';
      for (const [key, unit, otherwise] of [['preload', moment ? 'N m' : 'N', 1e3], ['stiffness', moment ? 'N m/rad' : 'N/m', 1e5]]) {
        const start = push[key] ?? 0;
        inputs.push({
          group: 'Tensioners', key: `${key} ${name}`, label: `${key} of ${name}`, hint: 'of its spring',
          unit, factor: 1, range: upTo(start, 3, otherwise), start,
          set: (value) => [['set', { kind: 'parameter', name: `tensioners.${name}.push.${key}`, value }]],
          inScene: (value) => [[`tensioners.${name}.push.${key}`, value]],
        });
      }
    }
    const { at } = carrier.plunger ?? {};
    const lever = turns && at ? Math.hypot(at[0] - carrier.pivot[0], at[1] - carrier.pivot[1]) : 1;
    const size = 2 * Math.abs(push.preload || 100) * lever;
    inputs.push({
      group: 'Tensioners', key: `force ${name}`, label: `${turns ? 'torque' : 'force'} on ${name}`, hint: 'beside its own push; positive where that pushes',
      unit: turns ? 'N m' : 'N', factor: 1, range: [-size, size], start: 0,
      set: (value) => [['set', { kind: 'force', name, value, over }]],
    });
  }
  for (const { name, support } of sprockets) {
    if (support && !['fixed', 'prescribed'].includes(support.kind ?? support)) continue;
    const reach = centreReach(facts);
    for (const axis of ['x', 'y']) {
      inputs.push({
        group: 'Centres', key: `centre ${name} ${axis}`, label: `${name} moved in ${axis}`, hint: 'from where it stands; it goes there within four pitches, without a jerk of speed',
        unit: 'mm', factor: 1e3, range: [-reach, reach], start: 0, over: 4 * (mesh ?? sampling(facts) * IN_A_PITCH),
        move: { kind: `centre_${axis}`, name },
      });
    }
  }
  return inputs;
}

/** How far a centre may be moved [m]: until the chain is pulled some three times as tight. */
function centreReach({ chains, shafts, pitch }) {
  const [chain] = chains;
  const torques = shafts.map((it) => Math.abs(meanTorque(list(it.load))));
  const tension = Math.max(chain?.route?.pretension ?? 0, ...torques.map((it) => it / (3 * pitch)));
  const links = chain?.links ?? 100;
  // Two spans give way: F = 2 k d / n.
  const reach = chain?.stiffness > 0 ? (1.5 * tension * links) / chain.stiffness : 0;
  return roundDown(Math.min(0.15 * pitch, Math.max(0.02 * pitch, reach)));
}

/** Inputs with which the drive starts anew: `{ …, path }` of the scene. */
function anewInputs(facts) {
  const { scene, sprockets } = facts;
  const inputs = [];
  const add = (group, label, path, unit, factor, range, start, more = {}) => {
    inputs.push({ group, key: path, label, path, unit, factor, range, start, ...more });
  };
  const chains = scene.chain ? [['chain', 'route', scene.chain, scene.route, '']]
    : list(scene.chains).map((it, i) => [`chains[${i}]`, `chains[${i}].route`, it, it.route, ` of ${it.name}`]);
  for (const [chain, route, it, way, of] of chains) {
    const isClosed = !it.ends && (!it.start || way) && sprockets.length > 1;
    if (isClosed && !way?.sag) add('Chain', `pretension${of}`, `${route}.pretension`, 'N', 1, upTo(way?.pretension, 3, 1000), way?.pretension ?? 0);
    if (isClosed) add('Chain', `links${of}`, `${chain}.links`, '', 1, [Math.max(8, it.links - 8), it.links + 8], it.links, { whole: true });
    add('Chain', `wear${of}`, `${chain}.elongation`, '%', 100, [0, 0.03], it.elongation ?? 0, { hint: 'by how much every link is longer than new' });
    if (it.damping_ratio !== undefined) add('Chain', `damping ratio of links${of}`, `${chain}.damping_ratio`, '', 1, [0, 0.2], it.damping_ratio);
  }
  for (const [place, words] of [['joints', 'joints'], ['teeth', 'teeth'], ['guides', 'guides']]) {
    const coefficient = scene.contact?.[place]?.friction?.coefficient;
    if (place === 'guides' && !list(scene.guides).length) continue;
    if (Number.isFinite(coefficient)) add('Friction', `coefficient in ${words}`.replace('in teeth', 'on teeth').replace('in guides', 'on guides'), `contact.${place}.friction.coefficient`, '', 1, [0, 0.4], coefficient);
  }
  sprockets.forEach((it, i) => {
    add('Teeth', it.name, `sprockets[${i}].teeth`, '', 1, [Math.max(5, Math.ceil(0.7 * it.teeth)), Math.floor(1.4 * it.teeth)], it.teeth, { whole: true });
  });
  return inputs;
}

/** Sliders with numbers beside them. */
class Sliders {
  constructor(place, changed) {
    Object.assign(this, { place, changed, inputs: new Map(), undone: [] });
  }

  /** Sliders for these inputs; those that are called as before keep their values. */
  open(live, anew) {
    const before = this.inputs;
    this.inputs = new Map();
    this.place.replaceChildren();
    this.section('While it moves', live, before);
    this.section('Starts anew', anew, before);
  }

  section(title, inputs, before) {
    if (!inputs.length) return;
    const section = document.createElement('section');
    const heading = document.createElement('h2');
    heading.textContent = title;
    section.append(heading);
    const groups = new Map();
    for (const input of inputs) groups.set(input.group, [...(groups.get(input.group) ?? []), input]);
    for (const [name, members] of groups) {
      const group = document.createElement('details');
      // Many are folded away: one looks for them.
      group.open = !['Centres', 'Teeth'].includes(name) || members.length < 3;
      const summary = document.createElement('summary');
      summary.textContent = name;
      group.append(summary, ...members.map((input) => this.row(input, before.get(input.key))));
      section.append(group);
    }
    this.place.append(section);
  }

  row(input, before) {
    // The ends stay where they were: a slider does not run away from the hand.
    input.range = before?.range ?? input.range;
    const { label, hint, unit, factor, range: [least, most], whole } = input;
    const row = document.createElement('div');
    row.className = 'input';
    const id = `input-${this.inputs.size}`;
    const name = document.createElement('label');
    name.textContent = label;
    name.htmlFor = id;
    if (hint) row.title = hint;
    const slider = document.createElement('input');
    const number = document.createElement('input');
    const step = whole ? 1 : roundDown((factor * (most - least)) / 200);
    Object.assign(slider, { type: 'range', id, min: factor * least, max: factor * most, step: whole ? 1 : 'any' });
    Object.assign(number, { type: 'number', step });
    number.setAttribute('aria-label', `${label}${unit ? ` in ${unit}` : ''}`);
    const sign = document.createElement('span');
    sign.className = 'unit';
    sign.textContent = unit;
    const back = document.createElement('button');
    Object.assign(back, { type: 'button', textContent: '↺', title: 'As in the scene' });
    back.setAttribute('aria-label', `${label} as in the scene`);
    row.append(name, back, slider, number, sign);
    // A start that has been changed by an earlier slider is still that of the scene as opened.
    const start = before?.start ?? input.start;
    // `value` is what a slider shows, `acts` what the drive has taken.
    Object.assign(input, { start, acts: input.start, value: before && !input.path ? before.value : input.start, slider, number, back });
    this.inputs.set(input.key, input);
    this.show(input);
    const take = (text, done) => {
      const value = Number(text) / factor;
      if (text === '' || !Number.isFinite(value)) {
        tell(`${label}: write a number; it stays as it was.`, 'doubt');
        return this.show(input);
      }
      const within = whole ? Math.round(value) : value;
      return this.choose(input, within, done);
    };
    slider.oninput = () => take(slider.value, false);
    slider.onchange = () => take(slider.value, true);
    slider.ondblclick = () => this.choose(input, input.start, true);
    number.onchange = () => take(number.value, true);
    back.onclick = () => this.choose(input, input.start, true);
    return row;
  }

  /** Takes a value; with `done` it can be undone, and a start anew begins. */
  choose(input, value, done) {
    input.from ??= input.value;
    input.value = value;
    this.show(input);
    if (done && input.from !== value) this.undone.push([input.key, input.from]);
    const moved = !done || input.from !== value || !input.path;
    if (done) input.from = null;
    if (moved && (done || !input.path)) this.changed(input);
  }

  show(input) {
    const { slider, number, back, value, start, factor } = input;
    slider.value = factor * value;
    number.value = +(factor * value).toPrecision(5);
    back.style.visibility = Math.abs(value - start) > 1e-9 * Math.max(Math.abs(start), 1e-9) ? 'visible' : 'hidden';
  }

  /** Shows what acts again, in place of a value that was not taken. */
  takeBack(input) {
    input.value = input.acts;
    this.show(input);
  }

  /** Takes the last change back. */
  undo() {
    const last = this.undone.pop();
    const input = last && this.inputs.get(last[0]);
    if (!input) return;
    input.value = last[1];
    this.show(input);
    this.changed(input);
  }

  /** Values that are not those of the scene. */
  get changes() {
    return [...this.inputs.values()].filter((it) => it.value !== it.start);
  }

  forget() {
    this.inputs.clear();
    this.undone = [];
  }
}
