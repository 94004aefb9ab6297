// What the picture answers to, and what stands on it.

const byId = (id) => document.getElementById(id);

/** Shares of real time that can be chosen. */
const SPEEDS = [1, 2, 5, 10, 20, 50, 100, 200, 500, 1000, 2000, 5000, 10000, 50000];

/** Offers them in a list. */
function fillSpeeds(choice) {
  for (const slowness of SPEEDS) choice.add(new Option(slowness === 1 ? 'real time' : `1 : ${slowness}`, slowness));
}

/** Scale of tension in the legend: its colours, and its ends as texts. */
function tellTension(view, [slackest, tightest]) {
  const c = byId('scale').getContext('2d');
  const { width, height } = byId('scale');
  view.colours.scale.forEach((colour, i) => {
    c.fillStyle = colour;
    c.fillRect((i * width) / STEPS, 0, width / STEPS + 1, height);
  });
  byId('slackest').textContent = slackest;
  byId('tightest').textContent = tightest;
}

/** Scale bar and the arrow of the legend, which change as one looks closer. */
function tellLengths(view) {
  const length = roundDown(110 / view.window.scale);
  byId('bar').style.width = `${length * view.window.scale}px`;
  byId('length').textContent = quantity(length, 'm');
  if (byId('force').hidden) return;
  const force = roundDown(view.largestForce);
  const arrow = (view.longest() * force) / view.largestForce;
  byId('sample').textContent = quantity(force, 'N');
  byId('arrow').setAttribute('width', arrow + 2);
  byId('arrow').firstElementChild.setAttribute('d', `M0 5H${arrow}m-5-2.5l5 2.5l-5 2.5`);
}

/** The numbers of a roller beside the picture, and the contact that it has just begun; nothing without a roller. */
function tellRoller(view, roller, touched = null) {
  const place = byId('followed');
  place.hidden = roller < 0;
  if (roller < 0) return;
  const { film: { arrays, chains }, frame } = view;
  const millimetres = (value) => withMinus(`${(value * 1e3).toFixed(2)} mm`);
  const [x, y] = view.roller(roller);
  const rows = [['x', millimetres(x)], ['y', millimetres(y)]];
  const chain = chains.findLast((it) => it.firstRoller <= roller);
  const link = roller - chain.firstRoller;
  if (arrays.contact_force) rows.push(['on the teeth', quantity(arrays.contact_force.at(frame, roller), 'N')]);
  if (arrays.link_tension && link < chain.links) {
    rows.push(['link after it', quantity(arrays.link_tension.at(frame, chain.firstLink + link), 'N')]);
  }
  if (touched?.peak) rows.push(['peak to come', quantity(touched.peak, 'N')]);
  const table = document.createElement('table');
  table.createCaption().textContent = touched ? `Roller ${roller} touches ${touched.body || 'the teeth'}` : `Roller ${roller}`;
  for (const cells of rows) {
    const row = table.insertRow();
    for (const text of cells) row.insertCell().textContent = text;
  }
  place.replaceChildren(table);
}

/** Whether a text or a number is written in an element. */
const isWritten = ({ tagName, type }) => tagName === 'TEXTAREA' || (tagName === 'INPUT' && type !== 'range');

/** Keys of the page, each with what it does. Lists and fields keep their own, and a button that has the focus keeps the space bar. */
function listenToKeys(actions) {
  document.addEventListener('keydown', (event) => {
    const { key, target } = event;
    if (event.ctrlKey || event.metaKey || event.altKey || document.querySelector('dialog[open]')) return;
    if (isWritten(target) || target.tagName === 'SELECT') return;
    if (key === ' ' && ['BUTTON', 'SUMMARY'].includes(target.tagName)) return;
    const action = actions[key];
    if (!action) return;
    event.preventDefault();
    action(event.shiftKey);
  });
  // After a click the keys are those of the page again; whoever came by the keyboard keeps his place.
  document.addEventListener('click', (event) => {
    if (event.detail) event.target.closest('button')?.blur();
  });
}

/** Mouse, pen and fingers on the picture; what `player.view` shows may be another drive later. A player that can `pull` takes what is dragged at a roller. */
function listenToPicture(canvas, player) {
  const fingers = new Map();
  let [moved, pulled] = [0, -1];
  const place = (event) => [event.offsetX, event.offsetY];
  canvas.addEventListener('pointerdown', (event) => {
    canvas.setPointerCapture(event.pointerId);
    fingers.set(event.pointerId, place(event));
    moved = 0;
    pulled = player.pull && player.view && fingers.size === 1 ? player.view.rollerAt(...place(event)) : -1;
  });
  canvas.addEventListener('pointermove', (event) => {
    const before = fingers.get(event.pointerId);
    const { view } = player;
    if (!before || !view) return;
    const now = place(event);
    const [dx, dy] = [now[0] - before[0], now[1] - before[1]];
    moved += Math.hypot(dx, dy);
    if (fingers.size === 2) {
      if (pulled >= 0) player.letGo();
      pulled = -1;
      const other = [...fingers].find(([id]) => id !== event.pointerId)[1];
      const apart = (from) => Math.hypot(from[0] - other[0], from[1] - other[1]);
      const middle = [0.5 * (now[0] + other[0]), 0.5 * (now[1] + other[1])];
      view.zoom(apart(now) / Math.max(1, apart(before)), ...middle);
      view.pan(0.5 * dx, 0.5 * dy);
    } else if (moved > 4 && pulled >= 0) player.pull(pulled, now);
    else if (moved > 4) {
      canvas.classList.add('dragged');
      if (view.followed >= 0) player.follow(-1);
      view.pan(dx, dy);
    }
    fingers.set(event.pointerId, now);
    player.dirty = true;
  });
  const lift = (event) => {
    const { view } = player;
    const single = view && fingers.size === 1 && moved <= 4 && event.type === 'pointerup';
    if (single) {
      const roller = view.rollerAt(...place(event));
      if (roller >= 0 || view.followed >= 0) player.follow(roller === view.followed ? -1 : roller);
    }
    if (pulled >= 0 && moved > 4) player.letGo();
    pulled = -1;
    fingers.delete(event.pointerId);
    canvas.classList.remove('dragged');
  };
  canvas.addEventListener('pointerup', lift);
  canvas.addEventListener('pointercancel', lift);
  canvas.addEventListener('wheel', (event) => {
    event.preventDefault();
    player.view?.zoom(Math.exp(-0.0015 * event.deltaY), ...place(event));
    player.dirty = true;
  }, { passive: false });
}
