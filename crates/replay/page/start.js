// Reads the film, puts the page together, and hands out `window.replay` for programs.

/** Texts of the page that the film decides. */
function describe(film) {
  const { about, arrays } = film;
  const parts = [];
  const part = (text, style) => {
    const span = document.createElement('span');
    span.textContent = text;
    if (style) span.className = `verdict ${style}`;
    parts.push(span);
  };
  if (about.verdict) part(about.verdict, about.verdict);
  if (about.status !== 'complete') {
    part(about.failure ? `${about.status}: ${about.failure}` : about.status, about.status === 'running' ? 'caution' : 'distrusted');
  }
  const frames = about.stride > 1
    ? `${film.frames} of ${about.samples} samples, one in ${about.stride}`
    : `${film.frames} samples`;
  part(frames);
  part(about.version);
  if (about.note) parts[0].title = about.note;
  parts.forEach((span, i) => byId('subtitle').append(i ? ' · ' : '', span));

  byId('account').hidden = !about.summary;
  byId('story').querySelector('pre').textContent = about.summary;
  const { distance, channel, curve } = film.quanta;
  const percent = (share) => `±${+(50 * share).toPrecision(3)} %`;
  const exact = `exact to ±${quantity(0.5 * distance, 'm')}, ${percent(channel)} of the largest value, curves to ${percent(curve)} of their range`;
  byId('quantum').textContent = exact;
  const names = KEYS.map(([key]) => key);
  byId('help').querySelector('table').append(...KEYS.map(([, text], i) => {
    const row = document.createElement('tr');
    for (const cell of [names[i], text]) row.insertCell().textContent = cell;
    return row;
  }));
  byId('help').querySelector('.note').textContent =
    `Every picture is a recorded sample; nothing is drawn between two of them. Values are ${exact}. `
    + (arrays.event_start ? 'Contacts are those that the run has logged.'
      : 'Contacts were not logged: a contact begins at the first sample with a force on the teeth.');
}

/** Ends of the scales. */
function describeScales(film, view) {
  const { link_tension: tension, contact_force: force, contact_direction: direction } = film.arrays;
  byId('tension').hidden = !tension;
  if (tension) {
    const [least, most] = tension.range();
    const [slack, tight] = view.tension;
    tellTension(view, [(least < slack ? '≤ ' : '') + quantity(slack, 'N'), (most > tight ? '≥ ' : '') + quantity(tight, 'N')]);
  }
  byId('force').hidden = !(force && direction && view.largestForce > 0);
}

/** The theme of the reader's system, until he chooses another. */
function followTheme(player, film) {
  const root = document.documentElement;
  const dark = window.matchMedia('(prefers-color-scheme: dark)');
  const apply = (theme) => {
    root.dataset.theme = theme;
    player.view.colours = palette();
    describeScales(film, player.view);
    player.plots.redraw();
    player.dirty = true;
  };
  dark.addEventListener('change', () => apply(dark.matches ? 'dark' : 'light'));
  player.changeTheme = () => apply(root.dataset.theme === 'dark' ? 'light' : 'dark');
  apply(dark.matches ? 'dark' : 'light');
}

/** The film as a program sees it: frames, values in SI units, and the same steps as the buttons. */
function api(film, player) {
  /** The array and column of a channel's entry. */
  const found = (name, entry) => {
    if (film.arrays[name]) return [film.arrays[name], Number(entry)];
    const curve = film.curves.find((it) => it.channel === name && it.label === String(entry));
    if (!curve) throw new RangeError(`${name} of ${entry} is not in this film`);
    return [film.arrays[curve.stream], curve.column];
  };
  return {
    film,
    frames: film.frames,
    get frame() { return player.frame; },
    get playing() { return player.playing; },
    get scale() { return player.view.window.scale; },
    /** Where a roller is on the picture, as shares of its width and height. */
    seen(roller) {
      const [x, y] = player.view.toScreen(...player.view.roller(roller));
      return [x / player.view.width, y / player.view.height];
    },
    get timings() { return player.timings; },
    time: (frame) => film.arrays.time.at(frame, 0),
    /** A recorded value: of a roller, link or body by number, of a curve by its label. */
    value(name, frame, entry = '') {
      const [array, column] = found(name, entry);
      return array.at(frame, column);
    },
    quantum: (name, entry = '') => found(name, entry)[0].quantum,
    seek: (frame) => player.seek(frame),
    play: () => player.play(),
    pause: () => player.pause(),
    follow: (roller) => player.follow(roller),
    nextContact: (direction) => player.nextContact(direction),
    zoom(factor) {
      player.view.zoom(factor);
      player.dirty = true;
    },
  };
}

async function start() {
  const film = await readFilm();
  const view = new View(byId('picture'), film);
  let player;
  const plots = new Plots(byId('plots'), film, (moment) => player.seekTime(moment));
  plots.frame = 0;
  view.resize();
  player = new Player(film, view, plots);
  describe(film);
  listenToPicture(byId('picture'), player);
  listenToControls(player);
  followTheme(player, film);
  new ResizeObserver(() => {
    view.resize();
    plots.redraw();
    player.dirty = true;
  }).observe(byId('stage'));
  byId('wait').hidden = true;
  byId('wait').style.display = 'none';
  window.replay = api(film, player);
  requestAnimationFrame(() => requestAnimationFrame((now) => {
    window.replay.firstFrame = now;
  }));
}

start().catch((error) => {
  byId('wait').textContent = `This page cannot be shown: ${error.message}`;
  throw error;
});
