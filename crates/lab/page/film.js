// A film of one frame, which changes: the picture draws it like a recorded one.

/** Numbers of the present frame. */
class Live {
  constructor(values, stride = 1, offset = 0) {
    Object.assign(this, { values, stride, offset });
  }

  at(_, column) {
    return this.values[column * this.stride + this.offset];
  }

  range() {
    let [least, most] = [Infinity, -Infinity];
    for (let i = this.offset; i < this.values.length; i += this.stride) {
      const value = this.values[i];
      if (value < least) least = value;
      if (value > most) most = value;
    }
    return [least, most];
  }

  scaleRange() {
    const [least, most] = this.range();
    return least <= most ? [Math.min(0, least), most] : [0, 0];
  }
}

/** What is drawn of a drive: outlines that stay, and its last frame. */
class LiveFilm {
  constructor({ outlines, frame }) {
    this.bodies = outlines.bodies.map((body) => ({ ...body, lines: body.outlines }));
    this.chains = outlines.chains;
    this.frames = 1;
    placeChains(this);
    this.take(frame);
  }

  /** The link that is pulled hardest: its tension [N], and the share of its chain's breaking load [N]. */
  hardestPull(loads) {
    let found = { share: 0, tension: 0 };
    this.chains.forEach((chain, i) => {
      const tensions = this.arrays.link_tension.values.subarray(chain.firstLink, this.chains[i + 1]?.firstLink);
      const tension = tensions.reduce((most, it) => Math.max(most, it), 0);
      const share = tension / (loads[i] ?? Infinity);
      if (share > found.share) found = { share, tension };
    });
    return found;
  }

  take(frame) {
    this.arrays = Object.fromEntries(Object.entries(frame).map(([name, values]) => [name, new Live(values)]));
    ['body_x', 'body_y', 'body_angle'].forEach((name, axis) => {
      this.arrays[name] = new Live(frame.placements, 3, axis);
    });
  }
}

/** Seconds of wall time after which a scale has come down by two thirds. */
const DECAY = 3;

/** Lets the ends of the scales follow a drive: out at once, back slowly. */
function followScales(view, passed) {
  const { link_tension: tension, contact_force: force } = view.film.arrays;
  const kept = Math.exp(-passed / DECAY);
  const [least, most] = tension.scaleRange();
  const [slack, tight] = view.tension;
  view.tension = [Math.min(least, slack * kept), Math.max(most, tight * kept + most * (1 - kept))];
  const largest = force.scaleRange()[1];
  view.largestForce = Math.max(largest, view.largestForce * kept + largest * (1 - kept));
}
