// A pull at a roller: a spring between it and the hand.

/** How far the hand is away where the spring pulls with its greatest force [pixels]. */
const FULL_PULL = 90;

class Pull {
  constructor(lab) {
    Object.assign(this, { lab, roller: -1, hand: null, force: [0, 0], most: 0, refused: false });
  }

  /** Takes a roller, or goes on with it; the hand is at a place of the picture [pixels]. */
  take(roller, hand) {
    if (!this.lab.ready || this.refused) return;
    if (this.roller >= 0 && this.roller !== roller) this.letGo();
    // What the pull itself does to the tension does not make it stronger.
    if (this.roller < 0) this.most = this.meanTension();
    Object.assign(this, { roller, hand });
    this.lab.dirty = true;
  }

  /** Lets it go: the force ends. */
  letGo() {
    if (this.roller < 0) return;
    const { roller } = this;
    Object.assign(this, { roller: -1, hand: null, force: [0, 0] });
    this.lab.ended.push(roller);
    this.lab.dirty = true;
    if (!this.lab.playing) this.lab.flush();
  }

  /** Another drive has no pull; one that can be pulled at may follow one that cannot. */
  forget() {
    Object.assign(this, { roller: -1, hand: null, force: [0, 0], refused: false });
  }

  /** Mean tension of the links [N], the greatest force of a pull: it bends a span and breaks nothing. */
  meanTension() {
    const { values } = this.lab.film.arrays.link_tension;
    const mean = values.reduce((sum, it) => sum + Math.abs(it), 0) / (values.length || 1);
    return Math.max(mean, 1e-3);
  }

  /** The force now [N], towards the hand. */
  reckon() {
    const { view } = this.lab;
    const [u, v] = view.toScreen(...view.roller(this.roller));
    const [dx, dy] = [this.hand[0] - u, v - this.hand[1]];
    const away = Math.hypot(dx, dy);
    const size = this.most * Math.min(1, away / FULL_PULL);
    this.force = away > 0 ? [(size * dx) / away, (size * dy) / away] : [0, 0];
    return this.force;
  }

  /** Sets the force in the worker, along a ramp [s]; that of a roller that was let go ends. */
  async send(over) {
    const { core, ended } = this.lab;
    const set = async (roller, [x, y]) => {
      for (const [kind, value] of [['force_x', x], ['force_y', y]]) {
        await core.ask('set', { kind, name: `rollers.${roller}`, value, over });
      }
    };
    try {
      while (ended.length) await set(ended.shift(), [0, 0]);
      if (this.roller >= 0) await set(this.roller, this.reckon());
    } catch (error) {
      if (error.ended) throw error;
      this.forget();
      this.refused = true;
      tell(`This chain cannot be pulled at: ${error.message}`, 'doubt');
    }
  }

  /** The arrow of the force, and a line to the hand. */
  draw() {
    if (this.roller < 0) return;
    const { view } = this.lab;
    const { context: c, colours } = view;
    const [x, y] = this.reckon();
    const size = Math.hypot(x, y);
    c.strokeStyle = colours.faint;
    c.lineWidth = 1;
    c.setLineDash([3, 3]);
    c.beginPath();
    c.moveTo(...view.toScreen(...view.roller(this.roller)));
    c.lineTo(...this.hand);
    c.stroke();
    c.setLineDash([]);
    c.strokeStyle = colours.force;
    c.lineWidth = 2.4;
    c.beginPath();
    const [u, v] = view.traceArrow(this.roller, Math.atan2(y, x), (FULL_PULL * size) / this.most);
    c.stroke();
    c.fillStyle = colours.force;
    c.font = '600 12px system-ui, "DejaVu Sans", sans-serif';
    c.textAlign = 'center';
    c.textBaseline = 'middle';
    // Beyond the tip, where neither arrow nor chain lies.
    c.fillText(quantity(size, 'N', 2), u + (26 * x) / (size || 1), v - (16 * y) / (size || 1));
  }
}
