// What the reader can do: play, seek, look closer, follow, find the next contact.

const KEYS = [
  ['space', 'play, pause'],
  ['← →', 'one frame back, on; with shift a hundred'],
  ['home end', 'first, last frame'],
  ['[ ]', 'slower, faster'],
  ['+ −', 'closer, farther; also wheel or pinch'],
  ['0', 'whole drive'],
  ['f', 'follow a roller, or let it go; a click on a roller does the same'],
  ['n p', 'next contact, the one before; of the roller that is followed, if one is'],
  ['d', 'light, dark'],
  ['i', 'account of the run'],
  ['?', 'these keys'],
];

class Player {
  constructor(film, view, plots) {
    Object.assign(this, { film, view, plots, frame: 0, playing: false, dirty: true });
    this.times = film.arrays.time.values;
    this.moment = this.times[0];
    this.timings = [];
    this.slowness = this.gentleSpeed();
    this.step = (now) => this.tick(now);
    requestAnimationFrame(this.step);
  }

  get duration() {
    return this.times[this.film.frames - 1] - this.times[0];
  }

  /** The fastest speed at which rollers are seen to move: a third of a pitch a picture, and ten seconds in all. */
  gentleSpeed() {
    const { film } = this;
    let path = 0;
    const last = Math.min(film.frames, 400);
    for (let frame = 1; frame < last && film.rollers; frame++) {
      const [[x, y], [u, v]] = [this.view.roller(0, frame - 1), this.view.roller(0, frame)];
      path += Math.hypot(x - u, y - v);
    }
    const speed = path / (this.times[last - 1] - this.times[0] || 1);
    const slowness = Math.max((speed * 3) / (60 * this.view.pitch), 10 / (this.duration || 1));
    return SPEEDS.find((it) => it >= slowness) || SPEEDS.at(-1);
  }

  tick(now) {
    requestAnimationFrame(this.step);
    if (this.playing) {
      const passed = Math.min(0.1, (now - (this.last ?? now)) / 1e3);
      this.moment += passed / this.slowness;
      if (this.moment >= this.times[this.film.frames - 1]) {
        this.moment = this.times[this.film.frames - 1];
        this.pause();
      }
      this.show(frameBefore(this.times, this.moment));
    }
    this.last = now;
    if (!this.dirty) return;
    this.dirty = false;
    const start = performance.now();
    this.view.frame = this.frame;
    this.view.draw();
    this.plots.draw(this.frame);
    this.tell();
    this.timings.push(performance.now() - start);
    if (this.timings.length > 1000) this.timings.shift();
  }

  /** Shows a frame with the next picture. */
  show(frame) {
    const next = Math.max(0, Math.min(this.film.frames - 1, frame));
    if (next !== this.frame) this.dirty = true;
    this.frame = next;
  }

  seek(frame) {
    this.show(frame);
    this.moment = this.times[this.frame];
  }

  seekTime(moment) {
    this.seek(frameBefore(this.times, moment));
  }

  play() {
    if (this.frame === this.film.frames - 1) this.seek(0);
    this.playing = true;
    this.last = undefined;
    byId('play').textContent = '❚❚';
  }

  pause() {
    this.playing = false;
    byId('play').textContent = '▶';
  }

  toggle() {
    if (this.playing) this.pause();
    else this.play();
  }

  /** Goes slower or faster by some places of the list. */
  changeSpeed(places) {
    const at = SPEEDS.indexOf(this.slowness) + places;
    this.slowness = SPEEDS[Math.max(0, Math.min(SPEEDS.length - 1, at))];
    byId('speed').value = this.slowness;
  }

  follow(roller) {
    this.view.follow(roller);
    this.plots.follow(roller);
    this.view.marked = -1;
    byId('follow').value = roller;
    this.dirty = true;
  }

  /** The next contact, or with −1 the one before. */
  nextContact(direction = 1) {
    const { followed } = this.view;
    const contacts = contactsOf(this.film).filter(({ roller }) => followed < 0 || roller === followed);
    const next = direction > 0
      ? contacts.find(({ frame }) => frame > this.frame)
      : contacts.findLast(({ frame }) => frame < this.frame);
    if (!next) return;
    this.pause();
    this.seek(next.frame);
    this.view.marked = next.roller;
    this.view.bringIn(next.roller, next.frame);
    this.contact = next;
    this.dirty = true;
  }

  /** The numbers beside the picture. */
  tell() {
    const time = this.times[this.frame];
    const digits = Math.max(0, Math.min(9, 1 - Math.floor(Math.log10(this.duration / this.film.frames || 1))));
    byId('clock').innerHTML = `<b>${time.toFixed(digits)} s</b> <span>frame ${this.frame + 1} of ${this.film.frames}</span>`;
    byId('scrub').value = this.frame;
    const { view } = this;
    const roller = view.followed >= 0 ? view.followed : view.marked;
    const touched = view.marked === roller && this.contact?.frame === this.frame ? this.contact : null;
    tellLengths(view);
    tellRoller(view, roller, touched);
  }
}

/** Contacts in the order of time: those that were logged, or else the frames at which teeth begin to press. */
function contactsOf(film) {
  if (film.contacts) return film.contacts;
  const { arrays, frames, bodies } = film;
  const { event_start: start, event_roller: rollers, event_body: touched, event_peak_force: peak } = arrays;
  const contacts = [];
  if (start) {
    for (let i = 0; i < start.rows; i++) {
      const before = frameBefore(arrays.time.values, start.at(i, 0));
      const frame = Math.min(frames - 1, arrays.time.at(before, 0) < start.at(i, 0) ? before + 1 : before);
      contacts.push({ frame, roller: rollers.at(i, 0), body: bodies[touched.at(i, 0)]?.name, peak: peak.at(i, 0) });
    }
  } else if (arrays.contact_force) {
    const force = arrays.contact_force;
    for (let roller = 0; roller < force.columns; roller++) {
      for (let frame = 1; frame < frames; frame++) {
        if (force.at(frame, roller) > 0 && !(force.at(frame - 1, roller) > 0)) contacts.push({ frame, roller });
      }
    }
  }
  contacts.sort((a, b) => a.frame - b.frame);
  film.contacts = contacts;
  return contacts;
}

/** Buttons, lists and keys. */
function listenToControls(player) {
  const { view, film } = player;
  const zoom = (factor) => {
    view.zoom(factor);
    player.dirty = true;
  };
  const whole = () => {
    player.follow(-1);
    view.showAll();
  };
  const followOrNot = () => player.follow(view.followed >= 0 ? -1 : Math.max(0, view.marked));
  const open = (id) => byId(id).showModal();

  byId('play').onclick = () => player.toggle();
  byId('back').onclick = () => player.seek(player.frame - 1);
  byId('on').onclick = () => player.seek(player.frame + 1);
  byId('closer').onclick = () => zoom(1.4);
  byId('farther').onclick = () => zoom(1 / 1.4);
  byId('whole').onclick = whole;
  byId('contact').onclick = () => player.nextContact();
  byId('theme').onclick = () => player.changeTheme();
  byId('keys').onclick = () => open('help');
  byId('account').onclick = () => open('story');
  byId('scrub').max = film.frames - 1;
  byId('scrub').oninput = (event) => player.seek(Number(event.target.value));
  fillSpeeds(byId('speed'));
  byId('speed').value = player.slowness;
  byId('speed').onchange = (event) => {
    player.slowness = Number(event.target.value);
  };
  byId('follow').add(new Option('nothing', -1));
  for (let roller = 0; roller < film.rollers; roller++) byId('follow').add(new Option(`roller ${roller}`, roller));
  byId('follow').onchange = (event) => player.follow(Number(event.target.value));
  const hasContacts = film.arrays.event_start || film.arrays.contact_force;
  byId('contact').disabled = !hasContacts;

  listenToKeys({
    ' ': () => player.toggle(),
    ArrowLeft: (shift) => player.seek(player.frame - (shift ? 100 : 1)),
    ArrowRight: (shift) => player.seek(player.frame + (shift ? 100 : 1)),
    Home: () => player.seek(0),
    End: () => player.seek(film.frames - 1),
    '[': () => player.changeSpeed(1),
    ']': () => player.changeSpeed(-1),
    '+': () => zoom(1.4),
    '=': () => zoom(1.4),
    '-': () => zoom(1 / 1.4),
    0: whole,
    f: followOrNot,
    n: () => player.nextContact(),
    p: () => player.nextContact(-1),
    d: () => player.changeTheme(),
    i: () => byId('account').hidden || open('story'),
    '?': () => open('help'),
  });
}
