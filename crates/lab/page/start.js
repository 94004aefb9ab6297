// Puts the page together, opens the drive that it was given, and hands out `window.lab` for programs.

const LAB_KEYS = [
  ['space', 'play, pause'],
  ['.', 'some steps of the method'],
  ['[ ]', 'slower, faster'],
  ['r', 'reset: as in the scene, at t = 0'],
  ['a b', 'keep this state as A; back to A'],
  ['Ctrl+Z', 'take the last change of a slider back'],
  ['+ −', 'closer, farther; also wheel or pinch'],
  ['0', 'whole drive'],
  ['drag', 'pull at a roller or a span; elsewhere the picture moves'],
  ['f', 'follow a roller, or let it go; a click on a roller does the same'],
  ['e', 'text of the scene'],
  ['o', 'a drive of one\'s own'],
  ['d', 'light, dark'],
  ['?', 'these keys'],
];

/** Shows the text of the drive as it stands. */
async function editScene(lab) {
  if (!lab.scene) return lab.editor.show();
  const scene = await lab.sceneAsItStands();
  if (scene.left.length) tell(`No scene can hold it, so the text is without ${scene.left.join(', ')}.`, 'doubt');
  return lab.editor.show(scene);
}

/** What the picture, its buttons and its keys do. */
function listenToLab(lab) {
  const picture = {
    get view() { return lab.view; },
    set dirty(is) { lab.dirty = is; },
    pull: (roller, hand) => lab.pull.take(roller, hand),
    letGo: () => lab.pull.letGo(),
    follow(roller) {
      lab.view?.follow(roller);
      byId('follow').value = roller;
      Object.assign(lab, { dirty: true, toldAt: 0 });
    },
  };
  listenToPicture(byId('picture'), picture);
  const toggle = () => (lab.playing ? lab.pause() : lab.play());
  const zoom = (factor) => {
    lab.view?.zoom(factor);
    lab.dirty = true;
  };
  const whole = () => {
    picture.follow(-1);
    lab.view?.showAll();
    lab.dirty = true;
  };
  const followOrNot = () => picture.follow(lab.view?.followed >= 0 ? -1 : 0);
  const faster = (places) => {
    const at = SPEEDS.indexOf(Number(byId('speed').value)) + places;
    lab.setPace(1 / SPEEDS[Math.max(0, Math.min(SPEEDS.length - 1, at))]);
  };
  fillSpeeds(byId('speed'));
  for (const pitches of WINDOWS) byId('shown').add(new Option(`${pitches} pitches`, pitches));
  byId('shown').value = lab.scrolls.shown;
  byId('shown').onchange = (event) => {
    lab.scrolls.shown = Number(event.target.value);
    lab.scrolls.draw();
  };
  byId('speed').onchange = (event) => lab.setPace(1 / Number(event.target.value));
  byId('follow').onchange = (event) => picture.follow(Number(event.target.value));
  const undo = () => lab.sliders.undo();
  const buttons = {
    play: toggle, step: () => lab.step(), reset: () => lab.reset(), keep: () => lab.keepState(), 'back-to': () => lab.goBackToKept(),
    undo, closer: () => zoom(1.4), farther: () => zoom(1 / 1.4), whole, stop: () => lab.stop(), theme: () => lab.changeTheme(),
    keys: () => byId('help').showModal(), edit: () => lab.guarded(editScene(lab)), own: () => lab.own.show(), judge: () => lab.given && makeReport(lab),
    replay: () => lab.ready && lab.guarded(saveReplay(lab)),
    link: () => lab.scene && makeLink(lab).catch((error) => tell(error.message, 'bad')), 'message-away': () => tell(''),
    'kept-away': () => lab.scrolls.keep(null),
    further: () => findHorizon(lab, 4 * lab.horizon.follow),
  };
  for (const [id, action] of Object.entries(buttons)) byId(id).onclick = action;
  byId('report').addEventListener('close', () => lab.reportErrand.stop());
  const actions = {
    ' ': toggle, '.': () => lab.step(), '[': () => faster(1), ']': () => faster(-1), r: () => lab.reset(), a: () => lab.keepState(),
    b: () => lab.goBackToKept(), '+': () => zoom(1.4), '=': () => zoom(1.4), '-': () => zoom(1 / 1.4), 0: whole, f: followOrNot,
    e: () => lab.guarded(editScene(lab)), o: () => lab.own.show(), d: () => lab.changeTheme(), '?': () => byId('help').showModal(),
  };
  listenToKeys(actions);
  document.addEventListener('keydown', (event) => {
    if (!(event.ctrlKey || event.metaKey) || event.key !== 'z' || isWritten(event.target) || document.querySelector('dialog[open]')) return;
    event.preventDefault();
    undo();
  });
  byId('help').querySelector('table').append(...LAB_KEYS.map((cells) => {
    const row = document.createElement('tr');
    for (const cell of cells) row.insertCell().textContent = cell;
    return row;
  }));
}

/** Tabs beside the picture; the inputs are one of them where the page is narrow. */
function listenToTabs(lab) {
  const panels = ['inputs', 'curves', 'spectrum', 'energy'];
  const show = (chosen) => {
    document.body.dataset.tab = chosen;
    for (const button of byId('tabs').children) button.setAttribute('aria-selected', button.dataset.tab === chosen);
    for (const panel of panels.slice(1)) byId(panel).hidden = panel !== chosen;
    lab.scrolls.resize();
    lab.spectrum.draw();
    lab.toldAt = 0;
    lab.dirty = true;
  };
  for (const button of byId('tabs').children) button.onclick = () => show(button.dataset.tab);
  byId('tabs').addEventListener('keydown', (event) => {
    const by = { ArrowRight: 1, ArrowLeft: -1 }[event.key];
    if (!by) return;
    const buttons = [...byId('tabs').children].filter((it) => it.offsetWidth);
    const at = buttons.indexOf(document.activeElement) + by;
    const next = buttons[(at + buttons.length) % buttons.length];
    next.focus();
    next.click();
  });
  show('curves');
}

/** The theme of the reader's system, until he chooses another. */
function followTheme(lab) {
  const root = document.documentElement;
  const dark = window.matchMedia('(prefers-color-scheme: dark)');
  const apply = (theme) => {
    root.dataset.theme = theme;
    if (lab.view) lab.view.colours = palette();
    lab.spectrum.draw();
    lab.own.draw();
    lab.toldAt = 0;
    lab.dirty = true;
  };
  dark.addEventListener('change', () => apply(dark.matches ? 'dark' : 'light'));
  lab.changeTheme = () => apply(root.dataset.theme === 'dark' ? 'light' : 'dark');
  apply(dark.matches ? 'dark' : 'light');
}

async function start() {
  const module = await readModule();
  const lab = new Lab(module);
  lab.horizonErrand = new Errand(module);
  lab.reportErrand = new Errand(module);
  lab.onStarted = () => seekHorizon(lab);
  /** Opens a scene; the drive before goes on where it cannot be. */
  const open = async (asked) => {
    await lab.during(async () => {
      try {
        tell('');
        await lab.open(asked);
      } catch (error) {
        if (!error.ended) await lab.goBack(error);
        throw error;
      }
    });
    byId('preset').value = asked.preset ?? '';
  };
  lab.editor = new Editor(lab, open);
  lab.own = new OwnDrive(lab, open);
  listenToLab(lab);
  listenToTabs(lab);
  followTheme(lab);
  new ResizeObserver(() => {
    lab.view?.resize();
    lab.scrolls.resize();
    lab.spectrum.draw();
    lab.dirty = true;
  }).observe(byId('stage'));

  const presets = await lab.core.ask('presets');
  byId('preset').append(new Option('of one\'s own', ''), ...presets.map(({ name, about }) => {
    const option = new Option(name.replaceAll('_', ' '), name);
    option.title = about;
    return option;
  }));
  byId('preset').firstChild.disabled = true;
  // What is wrong has been told.
  const openPreset = (name) => open({ preset: name }).catch(() => {});
  byId('preset').onchange = (event) => openPreset(event.target.value);

  /** The scene of the page or of its address; mistakes in it are shown where they stand. */
  const openGiven = async () => {
    let [given, refused] = [null, ''];
    try {
      given = await sceneOfPage();
    } catch (error) {
      refused = `The scene in the address cannot be read: ${error.message}.`;
    }
    if (!given) {
      await openPreset(FIRST);
      if (refused) tell(refused, 'bad');
      return null;
    }
    return open(given).catch((error) => lab.editor.show(given, error.problems ?? [{ message: error.message }]));
  };
  window.addEventListener('hashchange', () => {
    if (lab.linked === window.location.hash) return;
    // The page goes on to another drive: coming back opens that of the link.
    lab.linked = null;
    openGiven();
  });
  await openGiven();
  byId('wait').hidden = true;
  byId('wait').style.display = 'none';
  const openedAt = performance.now();
  window.lab = {
    lab,
    openedAt,
    get time() { return lab.time; },
    get playing() { return lab.playing; },
    get ready() { return lab.ready; },
    get pictures() { return lab.frames; },
    open,
    setPace: (pace) => lab.setPace(pace),
    /** The last value of a curve, in its unit. */
    value(plot, label) {
      const at = lab.history.curves.findIndex((it) => it.plot === plot && it.label === label);
      return lab.history.series[at]?.[lab.history.length - 1];
    },
  };
}

/** The drive of a page that was given none. */
const FIRST = 'timing_drive';

start().catch((error) => {
  byId('wait').textContent = `This page cannot be shown: ${error.message}`;
  throw error;
});
