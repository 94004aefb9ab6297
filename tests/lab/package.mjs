// Does in Node what a test asks for, a list of requests in JSON, and answers likewise: node package.mjs PACKAGE

const chaindrive = await import(process.argv[2]);

const requests = {
  /** Roller centres at the start and after some steps, with the energies there. */
  motion({ text, steps }) {
    const drive = new chaindrive.Drive(text, 'scene');
    const moving = new chaindrive.Simulation(drive, 0);
    const names = 'roller_x,roller_y,energy_kinetic,energy_supplied,energy_residual';
    const read = () => {
      const recorder = new chaindrive.Recorder(moving, names, 1);
      recorder.advance(moving, moving.time, 1e9);
      const found = { time: moving.time, values: [...recorder.rows()] };
      recorder.free();
      return found;
    };
    const start = read();
    const begun = performance.now();
    moving.step(steps);
    const seconds = 1e-3 * (performance.now() - begun);
    return { start, end: read(), seconds, statistics: JSON.parse(moving.statistics()) };
  },

  /** What is said of a text that is no drive. */
  problems({ text }) {
    try {
      new chaindrive.Drive(text, 'scene').free();
      return { message: null };
    } catch (error) {
      return { message: error.message, problems: error.problems };
    }
  },

  /** All that is told of a drive at rest. */
  told({ text }) {
    const drive = new chaindrive.Drive(text, 'scene');
    return {
      description: drive.describe(),
      layout: JSON.parse(drive.layout()),
      svg: drive.svg(),
      resolved: JSON.parse(drive.resolved()),
    };
  },

  /** A run of its own, as its page says. */
  run({ text, until }) {
    const drive = new chaindrive.Drive(text, 'scene');
    const seen = [];
    const report = new chaindrive.RunReport(drive, until, (share) => seen.push(share));
    return { summary: report.summary, attributes: JSON.parse(report.attributes), seen };
  },

  /** A simulation in two pieces, by a snapshot that was written down. */
  snapshot({ text, steps }) {
    const drive = new chaindrive.Drive(text, 'scene');
    const whole = new chaindrive.Simulation(drive, 0);
    whole.step(steps);
    const bytes = whole.snapshot().toBytes();
    const rest = new chaindrive.Simulation(drive, 0);
    rest.restore(new chaindrive.Snapshot(bytes));
    return [whole, rest].map((it) => {
      it.step(steps);
      const recorder = new chaindrive.Recorder(it, 'roller_x,link_tension', 1);
      recorder.advance(it, it.time, 1e9);
      return [...recorder.rows()];
    });
  },

  known() {
    return {
      version: chaindrive.version(),
      set: chaindrive.instructionSet(),
      presets: JSON.parse(chaindrive.presets()),
      chains: JSON.parse(chaindrive.catalogueChains()),
      channels: JSON.parse(chaindrive.channels()),
      centres: JSON.parse(chaindrive.twoSprockets(19, 57, 25.4e-3, undefined, 120)),
    };
  },
};

let text = '';
for await (const part of process.stdin) text += part;
const answers = JSON.parse(text).map(([what, given]) => requests[what](given ?? {}));
process.stdout.write(JSON.stringify(answers));
