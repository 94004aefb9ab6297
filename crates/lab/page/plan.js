// A drive of one's own: a chain of the catalogue, wheels, guides; and the text of its scene.

/** What wheels do: a word, and the quantity that goes with it. */
const ROLES = {
  drives: ['drives', 'rpm'],
  driven: ['is driven', 'N m'],
  idler: ['idler inside', ''],
  outside: ['idler outside', ''],
};

/** Density of steel [kg/m³]. */
const STEEL = 7850;

/** Width of teeth, in inner widths of the chain. */
const TOOTH_WIDTH = 0.93;

/** Share of the breaking load that a new plan is pulled tight with, and that its load pulls with: *assumed*. */
const TIGHT = 0.02;
const LOADED = 0.08;

class Plan {
  constructor(chains) {
    this.chains = chains;
    this.type = '16B-1';
    this.wheels = [
      { name: 'driver', teeth: 19, x: 0, y: 0, role: 'drives', value: 300 },
      { name: 'driven', teeth: 38, x: 0.6, y: 0, role: 'driven', value: 0 },
    ];
    this.guides = [];
    this.links = null;
    this.moved = null;
    this.load();
  }

  /** A plan with the chain, wheels and guides of a scene that was read; null where it is no such drive. */
  static of(chains, { chain, sprockets = [], guides = [] }) {
    const plan = new Plan(chains);
    const wheels = sprockets.map(({ name, teeth, centre: [x, y], side, motion, load }) => {
      const wheel = { name, teeth, x, y };
      if (motion) return { ...wheel, role: 'drives', value: +(RPM * motion.speed).toPrecision(9) };
      const torque = Math.abs(meanTorque(list(load)));
      if (list(load).length) return { ...wheel, role: 'driven', value: +torque.toPrecision(9) };
      return { ...wheel, role: side === 'right' ? 'outside' : 'idler', value: 0 };
    });
    const isPlain = chains.some((it) => it.name === chain?.type) && wheels.length > 1
      && wheels.filter((it) => it.role === 'drives').length === 1 && guides.every((it) => it.face.kind === 'on-span' && it.face.between);
    if (!isPlain) return null;
    Object.assign(plan, {
      type: chain.type, links: chain.links, wheels,
      guides: guides.map(({ name, face }) => ({ name, after: face.between[0], from: 100 * face.from, to: 100 * face.to, bow: face.bow ?? 0 })),
    });
    // A load is chosen where it is another than would be assumed.
    for (const wheel of wheels) wheel.isChosen = wheel.role === 'driven' && wheel.value !== plan.assumedLoad(wheel);
    return plan;
  }

  get chain() {
    return this.chains.find((it) => it.name === this.type);
  }

  /** Radius of a pitch circle [m]: p/(2 sin(π/z)). */
  radius({ teeth }) {
    return this.chain.pitch / (2 * Math.sin(Math.PI / teeth));
  }

  /** Takes another chain; the plan grows or shrinks with its pitch. */
  take(type) {
    const before = this.chain.pitch;
    this.type = type;
    const grown = this.chain.pitch / before;
    for (const wheel of this.wheels) {
      wheel.x = tidy(wheel.x * grown);
      wheel.y = tidy(wheel.y * grown);
    }
    for (const guide of this.guides) guide.bow = tidy(guide.bow * grown);
    this.load();
  }

  /** Loads that suit the chain, where nobody has chosen one. */
  load() {
    for (const wheel of this.wheels) {
      if (wheel.role === 'driven' && !wheel.isChosen) wheel.value = this.assumedLoad(wheel);
    }
  }

  /** A torque that suits the chain [N m]. */
  assumedLoad(wheel) {
    return +(LOADED * this.chain.breaking_load * this.radius(wheel)).toPrecision(2);
  }

  get order() {
    return this.ordered(this.wheels);
  }

  /** Wheels in the order in which a counter-clockwise chain passes them: by their angle about the middle of those inside. */
  ordered(wheels) {
    const inside = wheels.filter((it) => it.role !== 'outside');
    const middle = (axis) => inside.reduce((sum, it) => sum + it[axis], 0) / inside.length;
    const [x, y] = [middle('x'), middle('y')];
    const angle = (it) => Math.atan2(it.y - y, it.x - x);
    const sorted = [...wheels].sort((a, b) => angle(a) - angle(b));
    const first = sorted.findIndex((it) => it.role === 'drives');
    return first > 0 ? [...sorted.slice(first), ...sorted.slice(0, first)] : sorted;
  }

  name(kind) {
    const taken = new Set([...this.wheels, ...this.guides].map((it) => it.name));
    for (let i = 1; ; i++) if (!taken.has(`${kind}${i > 1 ? ` ${i}` : ''}`)) return `${kind}${i > 1 ? ` ${i}` : ''}`;
  }

  get spans() {
    return this.spansOf(this.order);
  }

  /** Spans between wheels in an order, each with its length and the direction out of the loop. */
  spansOf(order) {
    return order.map((from, i) => {
      const to = order[(i + 1) % order.length];
      const [dx, dy] = [to.x - from.x, to.y - from.y];
      const length = Math.hypot(dx, dy) || 1;
      // On the right of travel is the outside of a counter-clockwise loop.
      return { from, to, length, out: [dy / length, -dx / length] };
    });
  }

  /** The slack span without some wheel: after the driving sprocket where that turns counter-clockwise, before it else. */
  slackWithout(wheel) {
    const spans = this.spansOf(this.ordered(this.wheels.filter((it) => it !== wheel)));
    return this.wheels.find((it) => it.role === 'drives').value >= 0 ? spans[0] : spans.at(-1);
  }

  addSprocket() {
    const [right, top] = ['x', 'y'].map((axis) => Math.max(...this.wheels.map((it) => it[axis])));
    const left = Math.min(...this.wheels.map((it) => it.x));
    const wheel = { name: this.name('sprocket'), teeth: 25, x: tidy(0.5 * (left + right)), y: 0, role: 'driven', value: 0 };
    wheel.y = tidy(top + 2.5 * this.radius(wheel));
    this.wheels.push(wheel);
    this.load();
  }

  addIdler() {
    const wheel = { name: this.name('idler'), teeth: 17, x: 0, y: 0, role: 'idler', value: 0 };
    this.wheels.push(wheel);
    this.place(wheel);
  }

  /** Puts an idler into the slack span, which it bows by a twentieth: outwards from within the loop, inwards from without. */
  place(wheel) {
    const { from, to, length, out } = this.slackWithout(wheel);
    const side = wheel.role === 'outside' ? -1 : 1;
    const line = 0.5 * (this.radius(from) + this.radius(to));
    const reach = line + side * (0.05 * length - this.radius(wheel));
    wheel.x = tidy(0.5 * (from.x + to.x) + reach * out[0]);
    wheel.y = tidy(0.5 * (from.y + to.y) + reach * out[1]);
  }

  addGuide() {
    const taken = new Set(this.guides.map((it) => it.after));
    const free = this.spans.filter((it) => !taken.has(it.from.name)).sort((a, b) => b.length - a.length);
    if (!free.length) return;
    this.guides.push({ name: this.name('guide'), after: free[0].from.name, from: 25, to: 75, bow: tidy(0.15 * this.chain.pitch) });
  }

  remove(it) {
    this.wheels = this.wheels.filter((wheel) => wheel !== it);
    this.guides = this.guides.filter((guide) => guide !== it && guide.after !== it.name);
    if (this.moved === it.name) this.moved = null;
    this.links = null;
  }

  /** Wheels that may move until the links close: the one chosen, else an idler and the last that is driven. */
  get movers() {
    const chosen = this.wheels.find((it) => it.name === this.moved);
    if (chosen) return [chosen];
    const idler = this.wheels.find((it) => ['idler', 'outside'].includes(it.role));
    return [idler, this.wheels.findLast((it) => it.role === 'driven')].filter(Boolean);
  }

  /** Direction in which a wheel tightens the chain. */
  direction(mover) {
    const rest = this.wheels.filter((it) => it !== mover);
    const middle = (axis) => rest.reduce((sum, it) => sum + it[axis], 0) / rest.length;
    const [dx, dy] = [mover.x - middle('x'), mover.y - middle('y')];
    const length = Math.hypot(dx, dy) || 1;
    const sign = mover.role === 'outside' ? -1 : 1;
    return [(sign * dx) / length, (sign * dy) / length];
  }

  /** About as many links as the loop takes: p n ≈ Σ lengths of spans + p Σ z / N, of N wheels; even. */
  get roughLinks() {
    const spans = this.spans.reduce((sum, it) => sum + it.length, 0) / this.chain.pitch;
    const around = this.wheels.reduce((sum, it) => sum + it.teeth, 0) / this.wheels.length;
    return Math.max(4, 2 * Math.round(0.5 * (spans + around)));
  }

  /** The text of the scene; a mover goes wherever the links close. */
  text(mover = null, links = this.links) {
    const { chain, order } = this;
    const millimetres = (value) => `"${+(1e3 * value).toFixed(4)} mm"`;
    const lines = ['# Laid out in the lab. What is called assumed there nobody has measured: put in what you know.', '', 'title = "A drive of one\'s own"', '',
      '[chain]', `type = ${JSON.stringify(chain.name)}`];
    if (links && !mover) lines.push(`links = ${links}`);
    lines.push('damping_ratio = 0.03 # assumed: no measured value is published, 0.01 to 0.05 are in use');
    for (const wheel of this.wheels) {
      lines.push('', '[[sprockets]]', `name = ${JSON.stringify(wheel.name)}`, `teeth = ${wheel.teeth}`, `centre = [${millimetres(wheel.x)}, ${millimetres(wheel.y)}]`);
      if (wheel.role === 'outside') lines.push('side = "right"');
      if (wheel.role === 'drives') {
        lines.push(`motion = { kind = "constant", speed = "${wheel.value} rpm" }`);
        continue;
      }
      // A disc of steel: J = ½ ρ π b r⁴.
      const disc = 0.5 * STEEL * Math.PI * TOOTH_WIDTH * chain.inner_width * this.radius(wheel) ** 4;
      const isDriven = wheel.role === 'driven';
      const inertia = +((isDriven ? 5 : 1) * disc).toPrecision(3);
      lines.push(`inertia = "${inertia} kg m^2" # assumed: a disc of steel${isDriven ? ', five times over for what it drives' : ''}`);
      if (isDriven && wheel.value) {
        // Against the rotation.
        const sense = this.wheels.find((it) => it.role === 'drives').value >= 0 ? -1 : 1;
        lines.push(`load = [{ kind = "constant", torque = "${sense * wheel.value} N m" }]`);
      }
    }
    for (const guide of this.guides) {
      const i = order.findIndex((it) => it.name === guide.after);
      const next = order[(i + 1) % order.length];
      lines.push('', '[[guides]]', `name = ${JSON.stringify(guide.name)}`,
        `face = { kind = "on-span", between = [${JSON.stringify(guide.after)}, ${JSON.stringify(next.name)}], from = "${guide.from} %", to = "${guide.to} %", radius = ${millimetres(40 * chain.pitch)}, bow = ${millimetres(guide.bow)} }`);
    }
    const stops = order.flatMap((wheel) => [wheel.name, ...this.guides.filter((it) => it.after === wheel.name && it.bow > 0).map((it) => it.name)]);
    lines.push('', '[route]', `stops = [${stops.map((it) => JSON.stringify(it)).join(', ')}]`,
      `pretension = "${+(TIGHT * chain.breaking_load).toPrecision(3)} N" # assumed: 2 % of the breaking load`);
    if (mover) {
      const [dx, dy] = this.direction(mover);
      lines.push(`adjust = { kind = "sprocket", name = ${JSON.stringify(mover.name)}, direction = [${dx}, ${dy}], within = ${millimetres(6 * chain.pitch)} }`);
    }
    const driver = this.wheels.find((it) => it.role === 'drives');
    const turn = driver.value ? 60 / Math.abs(driver.value) : 1;
    lines.push('', '[run]', `until = "${+(5 * turn).toPrecision(3)} s"`, `every = "${+(1e3 * turn / driver.teeth / 64).toPrecision(3)} ms"`, '');
    return lines.join('\n');
  }
}

/** Equality of two scenes that were read, but for the rounding of numbers. */
function alike(one, other) {
  if (typeof one === 'number' && typeof other === 'number') return Math.abs(one - other) <= 1e-6 * Math.max(Math.abs(one), Math.abs(other), 1e-6);
  if (typeof one !== 'object' || typeof other !== 'object' || !one || !other) return one === other;
  const keys = Object.keys(one);
  return keys.length === Object.keys(other).length && keys.every((key) => alike(one[key], other[key]));
}

/** A length to a hundredth of a millimetre. */
const tidy = (length) => Math.round(1e5 * length) / 1e5;
