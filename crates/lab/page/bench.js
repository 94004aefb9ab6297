// What takes longer, each in a worker of its own: how long waveforms can be believed, and a whole run judged.

/** Asks a worker of its own one question, and ends it. */
class Errand {
  constructor(module) {
    this.module = module;
  }

  /** The answer; an errand that was on its way is given up. */
  async run(what, given, progress) {
    this.core?.end();
    const core = new Core(this.module, { progress });
    this.core = core;
    try {
      return await core.ask(what, given);
    } finally {
      core.end();
      if (this.core === core) this.core = null;
    }
  }

  stop() {
    this.core?.end();
  }
}

/** Finds how long waveforms of a drive can be believed, following it for some time [s]. */
async function findHorizon(lab, follow) {
  const { given } = lab;
  // What was found before stands until more is known.
  if (!lab.horizon?.sentence) lab.horizon = { follow, busy: true };
  tellHorizon(lab);
  try {
    const found = await lab.horizonErrand.run('horizon', { text: given.text, name: given.name, follow });
    if (given !== lab.given) return;
    lab.horizon = { follow, ...found };
    // Beyond what was followed the time is extrapolated, and marked all the same.
    lab.scrolls.horizon = found.time;
  } catch (error) {
    if (given !== lab.given || error.ended) return;
    lab.horizon = { follow, sentence: error.message, time: null, failed: true };
  }
  lab.dirty = true;
  tellHorizon(lab);
  const most = usualFollow(lab.facts);
  if (lab.horizon.time === null && !lab.horizon.failed && follow < most) await findHorizon(lab, Math.min(most, 4 * follow));
}

/** Milliseconds of play before the horizon is sought: how fast the machine computes is known then. */
const BEFORE_HORIZON = 1500;

/** Wall time that the twins of a drive may take at first [s]. */
const PATIENCE = 4;

/** Time for which the twins are followed without being asked [s]: 40 pitches. */
function usualFollow({ scene, mesh }) {
  const until = scene.run?.until ?? 1;
  return mesh ? Math.min(until, 40 * mesh) : 0.25 * until;
}

/** The same at first [s]: what comes within the patience. */
function firstFollow({ facts, rate }) {
  const most = usualFollow(facts);
  return Math.min(most, Math.max(0.1 * most, 0.5 * PATIENCE * (rate ?? Infinity)));
}

/** Seeks the horizon of a drive that has just been started. */
function seekHorizon(lab) {
  const { given } = lab;
  lab.horizonErrand.stop();
  Object.assign(lab, { horizon: null, rate: null });
  lab.scrolls.horizon = null;
  for (const id of ['horizon', 'horizon-sentence', 'horizon-of']) byId(id).textContent = '';
  setTimeout(() => {
    if (given === lab.given) findHorizon(lab, firstFollow(lab));
  }, BEFORE_HORIZON);
}

function tellHorizon(lab) {
  const { horizon, time, facts } = lab;
  const text = byId('horizon');
  byId('further').hidden = true;
  text.className = '';
  text.title = 'A twin of the drive starts a hair beside it; as long as both move alike, waves are those of the drive and not of rounding';
  if (!horizon) return;
  if (horizon.busy) {
    text.textContent = `How long waveforms can be believed: following a twin for ${quantity(horizon.follow, 's')} …`;
    return;
  }
  if (horizon.failed) {
    text.textContent = `How long waveforms can be believed is not known: ${horizon.sentence}`;
    byId('horizon-sentence').textContent = text.textContent;
    byId('horizon-of').textContent = '';
    return;
  }
  byId('further').hidden = false;
  byId('horizon-sentence').textContent = `${horizon.sentence[0].toUpperCase()}${horizon.sentence.slice(1)}.`;
  if (horizon.time === null) {
    text.textContent = time < horizon.follow ? `Waveforms can be believed for ${quantity(horizon.follow, 's')} at least.`
      : `Waveforms can be believed for ${quantity(horizon.follow, 's')} at least; followed no further.`;
  } else if (time < horizon.time) {
    text.textContent = `Waveforms can be believed for ${quantity(horizon.time, 's')}; after that means and orders only.`;
  } else {
    text.className = 'caution';
    text.textContent = `Past ${quantity(horizon.time, 's')}, where curves are shaded: believe means and orders, no longer single waves.`;
  }
  // Inputs that are changed while it moves have the same horizon after the change, of which nobody knows more.
  byId('horizon-of').textContent = lab.sliders.changes.some((it) => !it.path)
    ? `It was found for the scene; since then inputs have been changed.` : facts.mesh ? `${Math.round(horizon.follow / facts.mesh)} pitches were followed.` : '';
}

/** A whole run of the scene as it stands, judged in the background. */
async function makeReport(lab) {
  const dialog = byId('report');
  const text = byId('report-text');
  const bar = byId('report-progress');
  if (!dialog.open) dialog.showModal();
  text.textContent = '';
  bar.hidden = false;
  bar.removeAttribute('value');
  byId('report-save').disabled = true;
  byId('report-note').textContent = `Runs ${quantity(lab.facts.scene.run?.until ?? 1, 's')} of the scene from the start, chooses method and step, estimates the error. The drive goes on meanwhile.`;
  try {
    const { text: scene, name, left } = await lab.sceneAsItStands();
    const report = await lab.reportErrand.run('report', { text: scene, name }, (share) => {
      bar.value = share;
    });
    text.textContent = report.failure ? `${report.failure}\n\n${report.summary}` : report.summary;
    byId('report-note').textContent = left.length ? `Not part of a scene, and left out: ${left.join(', ')}.` : '';
    byId('report-save').disabled = false;
    byId('report-save').onclick = () => save(`${fileName(lab.scene)}.txt`, report.summary);
  } catch (error) {
    byId('report-note').textContent = error.message;
  }
  bar.hidden = true;
}
