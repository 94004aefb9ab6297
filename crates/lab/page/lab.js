// The lab: opens drives, moves them on, and tells what they do.

/** Milliseconds that the worker computes before it answers. */
const BUDGET = 25;

/** Time between two pictures with which every one has its curves [s]. */
const SMOOTH = 0.035;

/** Milliseconds between two snapshots, from which a new worker goes on. */
const SAFE = 2000;

class Lab {
  constructor(module) {
    Object.assign(this, {
      module, playing: false, asked: false, dirty: true, pending: new Map(), wanted: new Map(), opened: 0, spent: [], frames: 0, works: 0,
      scene: null, film: null, view: null, history: null, safe: null, kept: null, moves: new Map(),
    });
    this.scrolls = new Scrolls(byId('curves'));
    this.spectrum = new Spectrum(byId('spectrum-picture'), byId('spectrum-of'), byId('spectrum-note'));
    this.ledger = new Ledger(byId('ledger'));
    this.sliders = new Sliders(byId('inputs'), (input) => this.change(input));
    this.pull = new Pull(this);
    /** Rollers whose pull has to end in the worker. */
    this.ended = [];
    this.core = this.startCore();
    this.loop = (now) => this.show(now);
    requestAnimationFrame(this.loop);
  }

  startCore() {
    return new Core(this.module, { ended: (error) => this.recover(error) });
  }

  /** Whether something is read, assembled or gone back to. */
  get isBusy() {
    return this.works > 0;
  }

  /** Does some work, and is busy meanwhile. */
  async during(work) {
    this.works += 1;
    try {
      return await work();
    } finally {
      this.works -= 1;
    }
  }

  /** Bytes of the module's memory in the worker that moves the drive. */
  memory() {
    return this.core.ask('memory');
  }

  /** Opens a scene: `{ text, name }` or `{ preset }`; tells whether it moves. Mistakes are thrown. */
  async open(asked) {
    const about = await this.busy('Reading', this.core.ask('read', asked));
    const { base, changes, closing } = this;
    Object.assign(this, {
      base: { text: about.text, name: about.name, links: about.resolved.chain?.links }, changes: new Map(), closing: [],
    });
    try {
      await this.start(about, false);
    } catch (error) {
      // The drive before goes on.
      Object.assign(this, { base, changes, closing });
      throw error;
    }
  }

  /** Starts a drive that was read; `keep` has the curves before stay as those of A. */
  async start(about, keep) {
    const facts = factsOf(about);
    const every = sampling(facts);
    const given = { text: about.text, name: about.name, tunable: facts.tunables, channels: channelsOf(facts), every };
    const wasPlaying = this.playing;
    this.pause();
    this.opened += 1;
    const opened = this.opened;
    // What is drawn meanwhile is the drive before; nothing is asked of it any more.
    this.ready = false;
    const started = await this.busy('Assembling', this.core.ask('start', given));
    if (opened !== this.opened) return;
    const before = keep && this.history?.length ? this.history.copyFrom(-Infinity) : null;
    const sameCurves = before && this.sameCurves(before, facts, started, every);
    // The answer to the last tick, of the drive before, is not waited for.
    Object.assign(this, { scene: about, facts, given, started, kept: null, safe: null, ready: true, asked: false, spent: [] });
    this.moves.clear();
    this.pending.clear();
    this.pull.forget();
    this.ended = [];
    this.film = new LiveFilm(started);
    const shownBefore = this.view?.window;
    this.view = new View(byId('picture'), this.film);
    if (keep && shownBefore) this.view.window = shownBefore;
    this.view.resize();
    if (keep && shownBefore) Object.assign(this.view, { least: 0.05 * shownBefore.scale, most: 40 * shownBefore.scale });
    const { curves, channel } = curvesOf(facts, started, every);
    this.history = new History(curves, every);
    this.scrolls.open(this.history, facts);
    this.spectrum.open(this.history, facts);
    this.ledger.open(channel);
    if (sameCurves) this.scrolls.keep(before, 'before the start anew');
    if (!keep) this.sliders.forget();
    this.sliders.open(liveInputs(facts), anewInputs(facts));
    // Until a state is kept one goes back to the start.
    this.safe = this.withInputs({});
    if (!keep) this.setPace(gentlePace(facts));
    for (const input of this.sliders.changes.filter((it) => !it.path)) this.change(input);
    this.take(started);
    this.scrolls.resize();
    this.spectrum.draw();
    tellStepping(started.statistics);
    const changed = keep && this.changes.size ? ' (changed)' : '';
    byId('title').textContent = `${about.title || about.name || 'Chain drive'}${changed}`;
    document.title = `${about.title || 'Chain drive'} · lab`;
    byId('tension').hidden = false;
    byId('back-to').disabled = true;
    fillFollow(this.film);
    this.onStarted?.();
    // Whoever asks for less motion starts it himself.
    const isStill = window.matchMedia('(prefers-reduced-motion: reduce)').matches;
    if (wasPlaying || !(keep || isStill)) this.play();
  }

  /** Whether curves of before can stand beside those to come. */
  sameCurves(before, facts, started, every) {
    const { curves } = curvesOf(facts, started, every);
    return curves.length === before.curves.length && curves.every((it, i) => it.label === before.curves[i].label);
  }

  /** Waits for an answer; what takes longer than a glance is told, and can be stopped. */
  async busy(what, answer) {
    const shown = setTimeout(() => {
      byId('busy').hidden = false;
      byId('busy-what').textContent = `${what} …`;
    }, 250);
    try {
      return await answer;
    } finally {
      clearTimeout(shown);
      byId('busy').hidden = true;
    }
  }

  /** Ends whatever the worker does; the drive goes on from where it was kept last. */
  stop() {
    this.core.end();
    this.recover(null);
  }

  /** A new worker in place of one that has ended; it goes on from the last snapshot. */
  recover(error) {
    return this.during(() => this.goOn(error));
  }

  async goOn(error) {
    this.core = this.startCore();
    this.asked = false;
    this.opened += 1;
    const { given } = this;
    const why = error ? `The module stopped: ${error.message}.` : 'Stopped.';
    if (!given) {
      tell(`${why} Choose another drive.`, 'bad');
      return;
    }
    if (error && this.failed && performance.now() - this.failed < 8000) {
      this.pause();
      this.ready = false;
      tell(`${why} It stopped twice at the same place; change the drive, or open another.`, 'bad');
      return;
    }
    if (error) this.failed = performance.now();
    try {
      if (!await this.startAgain()) return;
      tell(`${why} A new one goes on ${this.fromNow()}`, 'doubt');
      if (this.playing) this.tick();
    } catch (second) {
      this.ready = false;
      tell(`${why} ${second.message}`, 'bad');
    }
  }

  /** Starts the drive of before again, from where it was kept last; tells whether it did: another may have been opened meanwhile. */
  async startAgain() {
    const { given, safe, opened } = this;
    const started = await this.busy('Assembling anew', this.core.ask('start', given));
    const back = safe.bytes ? await this.core.ask('restore', { bytes: safe.bytes }) : started;
    if (opened !== this.opened) return false;
    Object.assign(this, { ready: true, asked: false });
    this.takeBack(safe, back);
    return true;
  }

  /** Words for the time that was gone back to. */
  fromNow() {
    return `from t = ${quantity(this.time, 's', 4)}, with the inputs of that time.`;
  }

  /** Takes a state that was gone back to; sliders show what acts there. */
  takeBack({ acting, moves }, back) {
    this.history.cut(back.time);
    this.pending.clear();
    this.moves = new Map(moves);
    for (const [input, value] of acting) {
      input.acts = value;
      this.sliders.takeBack(input);
    }
    this.take(back);
  }

  /** The state now, from which one can go on later. */
  async snapshot(given) {
    // Answers come in the order of questions: what has been taken until now acts on this state, and nothing else.
    return this.withInputs(await this.core.ask('snapshot', given));
  }

  /** A state, with the values of inputs and the ways of centres that act on it. */
  withInputs(state) {
    const live = [...this.sliders.inputs.values()].filter((it) => !it.path);
    return { ...state, acting: live.map((it) => [it, it.acts]), moves: new Map(this.moves) };
  }

  /** Takes what the worker has computed. */
  take({ time, frame, samples }) {
    this.time = time;
    this.film.take(frame);
    this.warnOfBreaking();
    this.ledger.take(samples.rows);
    this.history.push(samples);
    this.dirty = true;
  }

  play() {
    if (!this.film || this.playing) return;
    this.playing = true;
    this.asking = performance.now();
    byId('play').textContent = '❚❚';
    byId('play').setAttribute('aria-label', 'Pause');
    this.tick();
  }

  pause() {
    this.playing = false;
    byId('play').textContent = '▶';
    byId('play').setAttribute('aria-label', 'Play');
  }

  /** Asks for the next frame, one at a time. */
  async tick() {
    if (!this.playing || this.asked || !this.ready) return;
    this.asked = true;
    const { opened } = this;
    try {
      const now = performance.now();
      const passed = Math.min(100, now - this.asking) / 1e3;
      await this.flush(this.pace * passed);
      this.asking = now;
      const begun = this.time;
      const answer = await this.core.ask('tick', { until: begun + this.pace * passed, budget: BUDGET });
      if (opened !== this.opened) return;
      this.take(answer);
      this.spent.push({ wall: passed, done: answer.done, spent: answer.spent, late: !answer.reached });
      if (this.spent.length > 60) this.spent.shift();
      this.late = !answer.reached;
      if (!(now - this.keptSafe < SAFE)) {
        this.keptSafe = now;
        this.safe = await this.snapshot();
      }
    } catch (error) {
      if (opened === this.opened && !error.ended) {
        this.pause();
        this.ready = false;
        tell(`The motion ends here: ${error.message}. Reset, or change an input that starts anew.`, 'bad');
      }
    } finally {
      if (opened === this.opened) this.asked = false;
    }
    // Behind time the worker has no rest; otherwise it waits for the next picture.
    if (this.late && opened === this.opened) this.tick();
  }

  /** Keeps a change for the next tick; one that starts anew begins at once. */
  change(input) {
    if (input.path) {
      this.wanted.set(input.path, input.value);
      this.during(() => this.renew());
    } else {
      this.pending.set(input.key, input);
      if (!this.playing) this.flush().catch((error) => tell(error.message, 'bad'));
    }
  }

  /** Sends the changes of sliders to the worker, and the pull of the hand along a ramp [s]. */
  async flush(over = 0) {
    if (!this.ready) return;
    if (this.pull.roller >= 0 || this.ended.length) await this.pull.send(over);
    const changed = [...this.pending.values()];
    this.pending.clear();
    for (const input of changed) {
      const taken = input.move ? this.moveCentre(input) : this.setValue(input);
      await taken.catch((error) => this.refuse(input, error));
    }
  }

  /** Has the drive take the value of a slider. */
  async setValue(input) {
    const { value } = input;
    for (const [what, given] of input.set(value)) await this.core.ask(what, given);
    input.acts = value;
  }

  /** Moves a centre on its way; until that ends the next way waits. */
  async moveCentre(input) {
    if (this.time < this.moves.get(input.key)) {
      this.pending.set(input.key, input);
      return;
    }
    const { value } = input;
    const by = value - input.acts;
    if (by === 0) return;
    this.moves.set(input.key, await this.core.ask('move', { ...input.move, by, over: input.over }));
    input.acts = value;
  }

  /** Takes a slider back whose value the drive refuses. */
  refuse(input, error) {
    if (error.ended) return;
    this.sliders.takeBack(input);
    tell(`${input.label}: ${error.message}`, 'doubt');
  }

  /** The scene with the values of sliders that a scene can hold; `left` are the names of the others. */
  async sceneAsItStands() {
    const { text, name } = this.scene;
    const changed = this.sliders.changes.filter((it) => !it.path);
    const left = changed.filter((it) => !it.inScene).map((it) => it.label);
    const changes = changed.flatMap((it) => it.inScene?.(it.value) ?? []);
    return changes.length ? { ...await this.core.ask('read', { text, name, changes }), left } : { text, name, left };
  }

  /** Starts anew with the values of the scene that have been changed, one start after the other. */
  async renew() {
    if (this.renewing) return;
    this.renewing = true;
    while (this.wanted.size) {
      const wanted = [...this.wanted];
      this.wanted.clear();
      await this.anew(wanted);
    }
    this.renewing = false;
  }

  /** Starts anew with values of the scene, `[path, value]`; the curves before stay in grey. */
  async anew(wanted) {
    const [before, closing] = [new Map(this.changes), this.closing];
    for (const [path, value] of wanted) {
      // What closed the loop after a change before is sought anew.
      if (CLOSED_BY.test(path)) this.closing = [];
      if (value === this.sliders.inputs.get(path)?.start) this.changes.delete(path);
      else this.changes.set(path, value);
    }
    const [path] = wanted.find((it) => CLOSED_BY.test(it[0])) ?? wanted[0];
    try {
      const { about, also, note } = await this.busy('Reading', readClosed(this.core, this.base, [...this.changes, ...this.closing], path));
      this.closing = [...this.closing, ...also];
      await this.start(about, true);
      if (!this.film.isWarned) tell(`Started anew${note ? ` ${note}` : ''}. The curves before stand in grey.`);
    } catch (error) {
      Object.assign(this, { changes: before, closing });
      for (const [place] of wanted) {
        const input = this.sliders.inputs.get(place);
        if (input) this.sliders.takeBack(input);
      }
      // A worker that has ended is told of and replaced elsewhere.
      if (!error.ended) await this.guarded(this.goBack(error));
    }
  }

  /** The drive before a start that failed: it moves on. */
  async goBack(error) {
    tell(told(error), 'bad');
    if (this.ready || !this.given) return;
    if (!await this.startAgain()) return;
    tell(`${told(error)}\nThe drive before goes on ${this.fromNow()}`, 'bad');
    this.playing = false;
    this.play();
  }

  /** Everything as in the scene, at t = 0. */
  async reset() {
    if (!this.base) return;
    await this.guarded(this.during(() => this.open(this.base)));
  }

  async step() {
    if (!this.ready) return;
    this.pause();
    await this.flush();
    const steps = Math.max(1, Number(byId('steps').value) || 1);
    await this.guarded(this.core.ask('step', { steps }).then((answer) => this.take(answer)));
  }

  /** Keeps the present state as A: one can come back to it, and what has been recorded since then stays in grey. */
  async keepState() {
    if (!this.ready) return;
    this.pause();
    await this.guarded(this.snapshot({ anew: true }).then((kept) => {
      this.kept = kept;
      byId('back-to').disabled = false;
      tell(`Kept as A at t = ${quantity(kept.time, 's', 4)}. Play on, come back to A, change something: its curves stand in grey beside B.`);
    }));
  }

  async goBackToKept() {
    if (!this.ready || !this.kept) return;
    this.pause();
    const { kept } = this;
    const curves = this.history.copyFrom(kept.time);
    await this.guarded(this.core.ask('restore', { bytes: kept.bytes }).then((back) => {
      this.takeBack(kept, back);
      this.scrolls.keep(curves.length > 1 ? curves : null, `A, from t = ${quantity(kept.time, 's', 4)} on`);
    }));
  }

  async guarded(promise) {
    try {
      await promise;
    } catch (error) {
      if (!error.ended) tell(error.message, 'bad');
    }
  }

  /** Tells once that a chain is pulled harder than it holds: it moves on, as no chain would. */
  warnOfBreaking() {
    if (this.film.isWarned) return;
    const { share, tension } = this.film.hardestPull(this.facts.chains.map((it) => it.breaking_load));
    if (share <= 1) return;
    this.film.isWarned = true;
    tell(`At t = ${quantity(this.time, 's')} a link is pulled with ${quantity(tension, 'N')}, and the chain breaks at ${quantity(tension / share, 'N')}. The drive moves on as if it held.`, 'bad');
  }

  setPace(pace) {
    // The nearest of those that can be chosen.
    const away = (it) => Math.abs(Math.log(it * pace));
    const slowness = SPEEDS.reduce((best, it) => (away(it) < away(best) ? it : best));
    this.pace = 1 / slowness;
    byId('speed').value = slowness;
    this.spent = [];
  }

  /** Shares of real time: how fast it plays, and how fast it could. */
  tellSpeeds() {
    const sum = (name) => this.spent.reduce((all, it) => all + it[name], 0);
    const [wall, done, spent] = [sum('wall'), sum('done'), 1e-3 * sum('spent')];
    const share = (value) => `${withMinus(+value.toPrecision(2))} ×`;
    const plays = this.playing && wall > 0 ? done / wall : null;
    put(byId('plays'), plays === null ? 'paused' : `plays at ${share(plays)} real time`);
    const isBehind = plays !== null && this.spent.length > 20 && plays < 0.85 * this.pace;
    byId('plays').className = isBehind ? 'caution' : '';
    byId('plays').title = isBehind ? `asked for ${share(this.pace)}: this machine computes no faster` : '';
    if (spent > 0) this.rate = done / spent;
    if (spent > 0) put(byId('computes'), `computes ${share(done / spent)} real time`);
  }

  /** One picture. */
  show(now) {
    requestAnimationFrame(this.loop);
    if (this.playing) this.tick();
    if (!this.dirty || !this.view?.window) return;
    this.dirty = false;
    const passed = Math.min(0.1, (now - (this.shownAt ?? now)) / 1e3);
    this.shownAt = now;
    this.frames += 1;
    followScales(this.view, passed);
    this.view.draw();
    this.pull.draw();
    // Where pictures come slowly the drive goes first.
    if (!this.playing || passed < SMOOTH || this.frames % 3 === 0) this.scrolls.draw();
    put(byId('clock'), clockText(this.time, this.history.every));
    if (now - (this.toldAt ?? 0) < 250) return;
    this.toldAt = now;
    this.tellSpeeds();
    const [slack, tight] = this.view.tension;
    // What is rounding beside the tight side is slack.
    tellTension(this.view, [quantity(Math.abs(slack) < 1e-4 * tight ? 0 : slack, 'N', 2), quantity(tight, 'N', 2)]);
    byId('force').hidden = !(this.view.largestForce > 0);
    tellLengths(this.view);
    tellRoller(this.view, this.view.followed);
    this.ledger.draw(this.history);
    if (!byId('spectrum').hidden) this.spectrum.draw();
    if (!byId('energy').hidden && this.ready) this.core.ask('statistics').then(tellStepping, () => {});
    tellHorizon(this);
  }
}

/** A mistake in a line: without the excerpts that a scene's text has in the editor. */
function told({ message, problems }) {
  return problems?.length ? problems.map((it) => `${it.path ? `${it.path}: ` : ''}${it.message}`).join('\n') : message;
}

/** A time that shows what changes. */
function clockText(time, every) {
  const digits = Math.max(0, Math.min(9, Math.ceil(-Math.log10(every)) - 1));
  return digits > 4 ? `t = ${(1e3 * time).toFixed(digits - 3)} ms` : `t = ${time.toFixed(digits)} s`;
}

/** A line over the picture, until the next one or until it is put away. */
function tell(text, how = '') {
  byId('message').hidden = !text;
  byId('message').className = how;
  byId('message-text').textContent = text;
  clearTimeout(tell.waiting);
  // What is only told goes by itself; mistakes stay.
  if (text && !how) tell.waiting = setTimeout(() => tell(''), READING);
}

/** Milliseconds in which a line is read. */
const READING = 9000;

/** Rollers that can be followed. */
function fillFollow(film) {
  const choice = byId('follow');
  choice.replaceChildren(new Option('nothing', -1));
  for (let roller = 0; roller < film.rollers; roller++) choice.add(new Option(`roller ${roller}`, roller));
}
