// The sheet on which a drive of one's own is laid out: wheels are dragged, the number of links is suggested.

class OwnDrive {
  constructor(lab, open) {
    Object.assign(this, { lab, open, dialog: byId('own-drive'), canvas: byId('own-picture'), layout: null, problem: '' });
    byId('own-type').onchange = (event) => {
      this.plan.take(event.target.value);
      this.change();
    };
    const adding = { 'own-sprocket': 'addSprocket', 'own-idler': 'addIdler', 'own-guide': 'addGuide' };
    for (const [id, add] of Object.entries(adding)) {
      byId(id).onclick = () => {
        this.plan[add]();
        this.change();
      };
    }
    byId('own-moved').onchange = (event) => {
      this.plan.moved = event.target.value || null;
      this.change(false);
    };
    byId('own-run').onclick = () => this.run();
    byId('own-text').onclick = () => {
      this.dialog.close();
      lab.editor.show({ text: this.plan.text(), name: 'own drive' });
    };
    this.listen();
    new ResizeObserver(() => this.draw()).observe(this.canvas);
  }

  async show() {
    if (!this.plan) {
      const chains = await this.lab.core.ask('chains');
      this.plan = new Plan(chains.filter((it) => it.inner_width > 0 && it.breaking_load > 0));
      for (const { name, ansi, pitch } of this.plan.chains) {
        const also = ansi && ansi !== name ? ` · ANSI ${ansi}` : '';
        byId('own-type').add(new Option(`${name}${also} · ${+(1e3 * pitch).toPrecision(5)} mm`, name));
      }
    }
    this.notice = '';
    await this.takeShown();
    byId('own-type').value = this.plan.type;
    if (!this.dialog.open) this.dialog.showModal();
    this.fill();
    this.lay();
  }

  /** Takes the drive that moves onto the sheet, where it was laid out on one: it may come from a file or a link. */
  async takeShown() {
    if (!this.lab.scene) return;
    const { text, name } = await this.lab.sceneAsItStands();
    if (text === this.shown) return;
    this.shown = text;
    if (text === this.plan.text()) return;
    const scene = await this.lab.core.ask('read', { text, name });
    const plan = Plan.of(this.plan.chains, scene.resolved);
    if (!plan) return;
    // Nothing of it is lost: its text is read as the same drive. How long it runs follows from its speed.
    const again = await this.lab.core.ask('read', { text: plan.text(), name: 'own drive' }).catch(() => null);
    if (again && alike({ ...again.resolved, run: null }, { ...scene.resolved, run: null })) this.plan = plan;
  }

  /** Lays the plan anew after something has changed; rows are made anew unless one is being written in. */
  change(rows = true) {
    this.plan.links = null;
    this.notice = '';
    // What is written in one field may move the value of another, as teeth move the load.
    if (rows) this.fill();
    else for (const show of this.shows) show();
    this.lay();
  }

  fill() {
    const { plan } = this;
    this.shows = [];
    byId('own-wheels').replaceChildren(...plan.wheels.map((wheel) => this.wheelRow(wheel)));
    byId('own-guides').replaceChildren(...plan.guides.map((guide) => this.guideRow(guide)));
    const moved = byId('own-moved');
    moved.replaceChildren(new Option('what moves least', ''), ...plan.wheels.map(({ name }) => new Option(name, name)));
    moved.value = plan.moved ?? '';
  }

  /** A field of a row, `scale` times what is kept. */
  field(it, key, label, { scale = 1, least, most, whole, text, after } = {}) {
    const input = document.createElement('input');
    const show = () => {
      input.value = text ? it[key] : +(scale * it[key]).toFixed(2);
    };
    this.shows.push(show);
    Object.assign(input, text ? { type: 'text', maxLength: 40 } : { type: 'number', step: whole ? 1 : 'any' });
    show();
    input.setAttribute('aria-label', `${label} of ${it.name}`);
    input.onchange = () => {
      const value = text ? input.value.trim() : Number(input.value) / scale;
      const isSound = text ? value && ![...this.plan.wheels, ...this.plan.guides].some((other) => other !== it && other.name === value)
        : input.value !== '' && Number.isFinite(value) && !(value < least) && !(value > most);
      if (isSound) {
        const before = it[key];
        it[key] = whole ? Math.round(value) : value;
        after?.(before);
        this.change(Boolean(text));
      } else {
        const bounds = [least === undefined ? '' : ` from ${scale * least}`, most === undefined ? '' : ` to ${scale * most}`].join('');
        this.notice = `${label} of ${it.name}: ${text ? 'a name that no other has' : `a number${bounds}`}, so it stays as it was.`;
        this.say(this.notice, 'bad');
        show();
      }
    };
    return input;
  }

  wheelRow(wheel) {
    const row = document.createElement('tr');
    const cell = (...what) => row.insertCell().append(...what);
    cell(this.field(wheel, 'name', 'name', { text: true, after: (before) => {
      for (const guide of this.plan.guides) if (guide.after === before) guide.after = wheel.name;
      if (this.plan.moved === before) this.plan.moved = wheel.name;
    } }));
    cell(this.field(wheel, 'teeth', 'teeth', { least: 6, most: 300, whole: true, after: () => this.plan.load() }));
    cell(this.field(wheel, 'x', 'x in mm', { scale: 1e3 }));
    cell(this.field(wheel, 'y', 'y in mm', { scale: 1e3 }));
    const role = document.createElement('select');
    role.setAttribute('aria-label', `What ${wheel.name} does`);
    for (const [key, [words]] of Object.entries(ROLES)) role.add(new Option(words, key));
    role.value = wheel.role;
    role.onchange = () => {
      const driver = this.plan.wheels.find((it) => it.role === 'drives');
      // One drives, no less and no more.
      if (role.value === 'drives' && driver !== wheel) Object.assign(driver, { role: 'driven', value: 0, isChosen: false });
      if (wheel === driver && role.value !== 'drives') {
        role.value = 'drives';
        return;
      }
      Object.assign(wheel, { role: role.value, value: role.value === 'drives' ? 300 : 0, isChosen: false });
      if (['idler', 'outside'].includes(role.value)) this.plan.place(wheel);
      this.plan.load();
      this.change();
    };
    cell(role);
    const [, unit] = ROLES[wheel.role];
    if (unit) {
      cell(this.field(wheel, 'value', unit === 'rpm' ? 'speed in rpm' : 'torque in N m', { least: unit === 'rpm' ? -1e5 : 0, after: () => {
        wheel.isChosen = true;
      } }), ` ${unit}`);
    } else cell('');
    cell(this.removal(wheel, this.plan.wheels.length < 3 || wheel.role === 'drives'));
    return row;
  }

  guideRow(guide) {
    const row = document.createElement('tr');
    const cell = (...what) => row.insertCell().append(...what);
    cell(this.field(guide, 'name', 'name', { text: true }));
    const span = document.createElement('select');
    span.setAttribute('aria-label', `Span of ${guide.name}`);
    for (const { from, to } of this.plan.spans) span.add(new Option(`${from.name} to ${to.name}`, from.name));
    span.value = guide.after;
    span.onchange = () => {
      guide.after = span.value;
      this.change(false);
    };
    cell('on ', span);
    cell('from ', this.field(guide, 'from', 'begin in % of the span', { least: 0, most: 99 }), ' to ', this.field(guide, 'to', 'end in % of the span', { least: 1, most: 100 }), ' %');
    cell('bow ', this.field(guide, 'bow', 'bow in mm', { scale: 1e3, least: 0 }), ' mm');
    cell(this.removal(guide, false));
    return row;
  }

  removal(it, disabled) {
    const button = document.createElement('button');
    Object.assign(button, { type: 'button', textContent: '×', title: 'Remove', disabled });
    button.setAttribute('aria-label', `Remove ${it.name}`);
    button.onclick = () => {
      this.plan.remove(it);
      this.change();
    };
    return button;
  }

  /** Asks the core how the chain lies; of several changes only the last is asked about. */
  async lay() {
    this.draw();
    // What closed the loop before the change may not close it now.
    for (const button of byId('own-fits').children) button.disabled = true;
    this.wanted = true;
    this.laying ??= this.layAnew().finally(() => {
      this.laying = null;
    });
    await this.laying;
  }

  async layAnew() {
    while (this.wanted) {
      this.wanted = false;
      const { plan } = this;
      try {
        // Any number of links shows where the chain lies, and which ones close.
        const about = await this.lab.core.ask('read', { text: plan.text(null, plan.links ?? plan.roughLinks), name: 'own drive' });
        [this.layout] = about.layout ?? [null];
        this.problem = about.unlaid;
        if (this.layout) this.fits = await this.fitsOf(plan);
      } catch (error) {
        Object.assign(this, { layout: null, fits: [], problem: told(error) });
      }
    }
    this.tellLayout();
    this.draw();
  }

  /** Numbers of links that close, each with the place of the wheel that moves for it. */
  async fitsOf(plan) {
    const found = [];
    for (const mover of plan.movers) {
      try {
        const about = await this.lab.core.ask('read', { text: plan.text(mover), name: 'own drive' });
        found.push(...(about.layout?.[0]?.fits ?? []).filter((it) => it.body === mover.name && it.centre));
      } catch (error) {
        // Where one cannot close the loop another may.
        if (error.ended) throw error;
      }
    }
    if (found.length) return found;
    return this.layout.fits.filter((it) => it.centre && plan.wheels.some((wheel) => wheel.name === it.body));
  }

  /** Numbers of links that close: even ones first, and those for which a wheel moves least. */
  get sorted() {
    return [...(this.fits ?? [])].sort((a, b) => a.offset_link - b.offset_link || Math.abs(a.travel) - Math.abs(b.travel));
  }

  get best() {
    return this.sorted[0] ?? null;
  }

  /** Whether the loop closes, but for what rounding the places leaves. */
  get isClosed() {
    return Boolean(this.plan.links && this.layout && Math.abs(this.layout.misfit) < 1e-4 * this.plan.chain.pitch);
  }

  tellLayout() {
    const { plan, layout } = this;
    const place = byId('own-fits');
    place.replaceChildren();
    byId('own-run').disabled = !layout;
    if (!layout) {
      this.say(this.problem || 'This cannot be laid out.', 'bad');
      return;
    }
    const { pitches } = layout.counts;
    if (this.notice) this.say(this.notice, 'bad');
    else this.say(this.isClosed ? `The loop closes with ${plan.links} links.` : `The chain's way takes ${pitches.toFixed(2)} pitches.`);
    if (this.isClosed) return;
    // Four are enough to choose from.
    for (const fit of this.sorted.slice(0, 4)) {
      const button = document.createElement('button');
      button.type = 'button';
      const isBest = fit === this.best;
      const odd = fit.offset_link ? ', with an offset link' : '';
      button.textContent = `${isBest ? 'Close the loop' : 'or'} with ${fit.links} links${odd}: ${fit.body} moves by ${withMinus((1e3 * Math.abs(fit.travel)).toFixed(1))} mm`;
      if (isBest) button.className = 'first';
      button.onclick = () => this.close(fit);
      if (isBest) place.prepend(button);
      else place.append(button);
    }
  }

  /** Writes a line under the plan. */
  say(text, how = '') {
    byId('own-state').className = how;
    byId('own-state').textContent = text;
  }

  /** Moves a wheel to where a number of links closes. */
  close(fit) {
    const wheel = this.plan.wheels.find((it) => it.name === fit.body);
    [wheel.x, wheel.y] = fit.centre;
    this.fill();
    this.plan.links = fit.links;
    return this.lay();
  }

  async run() {
    // What was written last may be on its way still.
    await this.laying;
    if (!this.layout) return;
    if (!this.isClosed && this.best) await this.close(this.best);
    try {
      await this.open({ text: this.plan.text(), name: 'own drive' });
      this.dialog.close();
    } catch (error) {
      this.say(told(error), 'bad');
    }
  }

  /** Mouse, pen and finger on the sheet: a wheel is dragged. */
  listen() {
    let dragged = null;
    this.canvas.addEventListener('pointerdown', (event) => {
      const [x, y] = this.toPlan(event.offsetX, event.offsetY);
      const away = (it) => Math.hypot(it.x - x, it.y - y);
      const near = this.plan.wheels.filter((it) => away(it) < Math.max(this.plan.radius(it), 14 / this.scale)).sort((a, b) => away(a) - away(b));
      if (!near.length) return;
      dragged = { wheel: near[0], dx: near[0].x - x, dy: near[0].y - y, window: { ...this.window } };
      this.canvas.setPointerCapture(event.pointerId);
    });
    this.canvas.addEventListener('pointermove', (event) => {
      if (!dragged) return;
      // The window stands still meanwhile, or the wheel would run from the hand.
      this.held = dragged.window;
      const [x, y] = this.toPlan(event.offsetX, event.offsetY);
      // Whole millimetres; the loop is closed afterwards.
      dragged.wheel.x = Math.round(1e3 * (x + dragged.dx)) / 1e3;
      dragged.wheel.y = Math.round(1e3 * (y + dragged.dy)) / 1e3;
      this.change();
    });
    const lift = () => {
      if (!dragged) return;
      dragged = null;
      this.held = null;
      this.draw();
    };
    this.canvas.addEventListener('pointerup', lift);
    this.canvas.addEventListener('pointercancel', lift);
  }

  get scale() {
    return this.window.scale;
  }

  toPlan(u, v) {
    const { x, y, scale, width, height } = this.window;
    return [x + (u - 0.5 * width) / scale, y - (v - 0.5 * height) / scale];
  }

  draw() {
    const { plan, canvas } = this;
    const { width, height } = canvas.getBoundingClientRect();
    if (!plan || !width) return;
    const density = window.devicePixelRatio || 1;
    canvas.width = Math.round(width * density);
    canvas.height = Math.round(height * density);
    const ends = (axis, sign) => Math.max(...plan.wheels.map((it) => sign * it[axis] + plan.radius(it)));
    const [right, left, top, low] = [ends('x', 1), -ends('x', -1), ends('y', 1), -ends('y', -1)];
    const fitted = { x: 0.5 * (left + right), y: 0.5 * (top + low), scale: Math.min((width - 60) / (right - left), (height - 60) / (top - low)), width, height };
    this.window = this.held ?? fitted;
    const { x: cx, y: cy, scale } = this.window;
    const at = ([x, y]) => [0.5 * width + (x - cx) * scale, 0.5 * height - (y - cy) * scale];
    const c = canvas.getContext('2d');
    const colours = palette();
    c.setTransform(density, 0, 0, density, 0, 0);
    c.clearRect(0, 0, width, height);
    c.font = '11px system-ui, "DejaVu Sans", sans-serif';
    c.textAlign = 'center';
    c.textBaseline = 'middle';
    for (const wheel of plan.wheels) {
      const [u, v] = at([wheel.x, wheel.y]);
      c.fillStyle = colours.steel;
      c.strokeStyle = colours['steel-line'];
      c.lineWidth = 1;
      c.beginPath();
      c.arc(u, v, plan.radius(wheel) * scale, 0, 2 * Math.PI);
      c.fill();
      c.stroke();
      c.fillStyle = colours.ink;
      c.fillText(`${wheel.name}, ${wheel.teeth}`, u, v);
      if (wheel.role === 'drives') this.drawSense(c, wheel, u, v, colours);
    }
    if (!this.layout || this.layout.stops.length < 2) return;
    c.strokeStyle = colours.accent;
    c.lineWidth = 2.5;
    c.beginPath();
    for (const span of this.layout.spans) {
      c.moveTo(...at(span.leaves));
      c.lineTo(...at(span.arrives));
    }
    c.stroke();
    this.layout.stops.forEach((stop, i) => {
      const before = this.layout.spans[(i + this.layout.spans.length - 1) % this.layout.spans.length];
      const after = this.layout.spans[i];
      const angle = ([x, y]) => -Math.atan2(y - stop.centre[1], x - stop.centre[0]);
      c.beginPath();
      // A canvas has its y axis down: counter-clockwise is backwards there.
      c.arc(...at(stop.centre), stop.radius * scale, angle(before.arrives), angle(after.leaves), stop.side === 'left');
      c.strokeStyle = stop.teeth ? colours.accent : colours.guide;
      c.stroke();
    });
  }

  /** The sense in which the driving sprocket turns. */
  drawSense(c, wheel, u, v, colours) {
    const radius = Math.max(12, 0.7 * this.plan.radius(wheel) * this.scale);
    const isBack = wheel.value < 0;
    const [from, to] = [-0.25 * Math.PI, -0.75 * Math.PI];
    c.strokeStyle = colours.force;
    c.lineWidth = 1.6;
    c.beginPath();
    c.arc(u, v, radius, from, to, true);
    const end = isBack ? from : to;
    const [x, y] = [u + radius * Math.cos(end), v + radius * Math.sin(end)];
    const side = isBack ? -1 : 1;
    c.moveTo(x + side * 7, y - 3);
    c.lineTo(x, y);
    c.lineTo(x + side * 1, y - 8);
    c.stroke();
  }
}
