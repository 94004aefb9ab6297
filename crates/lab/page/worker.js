// The worker: reads scenes, moves a drive, answers one question after the other. The glue of the module stands before it.

const { Drive, Simulation, Recorder, Picture, Film, Snapshot, RunReport } = wasm_bindgen;

/** What is in motion; nothing before `start`. */
let held = null;

/** Frames that a replay of the last while has: some seconds of play. */
const FILMED = 400;

/** Memory of the module. */
let memory = null;

/** Frees an object of the module that may not be there. */
const free = (it) => it?.free();

/** Reads a scene and hands on what it is. */
function described(drive) {
  let layout = null;
  let unlaid = '';
  try {
    layout = JSON.parse(drive.layout());
  } catch (error) {
    if (error instanceof WebAssembly.RuntimeError) throw error;
    unlaid = error.message;
  }
  return {
    text: drive.text, name: drive.name, title: drive.title, resolved: JSON.parse(drive.resolved()),
    tunables: JSON.parse(drive.tunables()), layout, unlaid,
  };
}

/** Does something with a drive that is read for it alone. */
function withDrive(drive, use) {
  try {
    return use(drive);
  } finally {
    drive.free();
  }
}

/** A recorder from the last reading on. */
function record() {
  free(held.recorder);
  held.recorder = null;
  held.recorder = new Recorder(held.moving, held.channels.join(','), held.every);
}

/** Begins a film with the present picture. */
function filmAnew() {
  free(held.film);
  held.film = null;
  held.film = new Film(held.picture, held.moving, FILMED);
}

/** Everything that the page draws and plots since the last answer, as copies that are handed over. */
function seen() {
  const { moving, recorder, picture, film } = held;
  picture.take(moving);
  film.take(picture, moving);
  const frame = {
    placements: picture.placements().slice(),
    roller_x: picture.rollerX().slice(),
    roller_y: picture.rollerY().slice(),
    link_tension: picture.linkTension().slice(),
    contact_force: picture.contactForce().slice(),
    contact_direction: picture.contactDirection().slice(),
  };
  const samples = { times: recorder.times().slice(), rows: recorder.rows().slice(), width: recorder.width };
  recorder.clear();
  const answer = { time: moving.time, frame, samples };
  const handed = [...Object.values(frame), samples.times, samples.rows].map((it) => it.buffer);
  return [answer, handed];
}

const answers = {
  presets: () => [JSON.parse(wasm_bindgen.presets())],
  chains: () => [JSON.parse(wasm_bindgen.catalogueChains())],
  build: () => [{ version: wasm_bindgen.version(), registers: wasm_bindgen.instructionSet() }],

  /** A scene by its text or the name of a preset, with values replaced. */
  read({ text, preset, name, changes = [] }) {
    const drive = preset ? Drive.preset(preset) : new Drive(text, name);
    if (!changes.length) return [withDrive(drive, described)];
    return [withDrive(drive, () => withDrive(drive.replaceAll(JSON.stringify(changes)), described))];
  },

  /** Sets a drive in motion. */
  start({ text, name, tunable, channels, every }) {
    if (held) Object.values(held).forEach((it) => it?.free?.());
    held = null;
    let drive = new Drive(text, name);
    if (tunable.length) {
      const read = drive;
      drive = read.replace('tunable', JSON.stringify(tunable));
      read.free();
    }
    const moving = new Simulation(drive, 0);
    held = { drive, moving, channels, every, recorder: null, picture: null, film: null };
    record();
    held.recorder.advance(moving, 0, 0);
    held.picture = new Picture(moving);
    filmAnew();
    const [answer, handed] = seen();
    const { recorder, picture } = held;
    return [{
      ...answer,
      outlines: JSON.parse(picture.outlines()),
      columns: [...recorder.columns()],
      labels: JSON.parse(recorder.labels()),
      statistics: JSON.parse(moving.statistics()),
    }, handed];
  },

  /** Goes on to a time [s] for some milliseconds at most; tells how many it took. */
  tick({ until, budget }) {
    const begun = performance.now();
    const from = held.moving.time;
    const reached = until > from ? held.recorder.advance(held.moving, until, budget) : true;
    const spent = performance.now() - begun;
    const [answer, handed] = seen();
    return [{ ...answer, reached, spent, done: answer.time - from }, handed];
  },

  /** Some steps of the method. */
  step({ steps }) {
    held.moving.step(steps);
    record();
    held.recorder.advance(held.moving, held.moving.time, 0);
    return seen();
  },

  /** Sets what acts on the drive, along a ramp of `over` [s]. */
  set({ kind, name, value, over = 0 }) {
    held.moving.set(kind, name, value, over);
    return [held.moving.time];
  },

  /** Moves a centre by a distance [m] within a time [s]: half of it with an acceleration, half with its opposite. */
  move({ kind, name, by, over }) {
    const { moving } = held;
    const begin = moving.time;
    // d = a (T/2)²
    const acceleration = (4 * by) / over ** 2;
    moving.setAt(begin, kind, name, acceleration);
    moving.setAt(begin + 0.5 * over, kind, name, -acceleration);
    moving.setAt(begin + over, kind, name, 0);
    return [begin + over];
  },

  memory: () => [memory.buffer.byteLength],
  statistics: () => [JSON.parse(held.moving.statistics())],

  /** The state; `anew` begins samples there, so that those of a motion that comes back to it stand at the same times. */
  snapshot({ anew }) {
    if (anew) record();
    const snapshot = held.moving.snapshot();
    const bytes = snapshot.toBytes();
    snapshot.free();
    return [{ time: held.moving.time, bytes }, [bytes.buffer]];
  },

  restore({ bytes }) {
    const snapshot = new Snapshot(bytes);
    try {
      held.moving.restore(snapshot);
    } finally {
      snapshot.free();
    }
    record();
    filmAnew();
    held.recorder.advance(held.moving, held.moving.time, 0);
    return seen();
  },

  /** A page that plays the last frames. */
  replay: ({ title }) => [held.film.page(title)],

  describe: ({ text, name }) => [withDrive(new Drive(text, name), (drive) => drive.describe())],
  horizon: ({ text, name, follow }) => [withDrive(new Drive(text, name), (drive) => JSON.parse(drive.horizon(follow)))],

  /** A whole run, judged. */
  report({ text, name, until }) {
    return [withDrive(new Drive(text, name), (drive) => {
      const told = (share) => postMessage({ progress: share });
      const report = new RunReport(drive, until, told);
      const answer = { summary: report.summary, attributes: JSON.parse(report.attributes), failure: report.failure };
      report.free();
      return answer;
    })];
  },
};

onmessage = ({ data: { module, id, what, given } }) => {
  if (module) {
    ({ memory } = wasm_bindgen.initSync({ module }));
    postMessage({ ready: true });
    return;
  }
  try {
    const [answer, handed = []] = answers[what](given ?? {});
    postMessage({ id, answer }, handed);
  } catch (error) {
    // After a panic the memory of the module cannot be relied on.
    const ended = error instanceof WebAssembly.RuntimeError;
    postMessage({ id, error: { message: error.message, problems: error.problems ?? null, ended } });
  }
};
