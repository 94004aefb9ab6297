// The ledger of energy, and what stands beside it: how exact, and for how long waveforms can be believed.

/** Rows of the ledger [J]: what stands there, and how it is reckoned from the energies. */
const LEDGER = [
  ['supplied by drives, loads taken off', (it) => it.supplied],
  ['lost in joints, contacts and dampers', (it) => it.dissipated],
  ['more in motion than at the start', (it) => it.kinetic],
  ['more in springs, contacts and weight', (it) => it.stored],
  ['unaccounted for', (it) => it.residual],
];

class Ledger {
  constructor(place) {
    this.cells = LEDGER.map(([name]) => {
      const row = place.insertRow();
      row.insertCell().textContent = name;
      return row.insertCell();
    });
  }

  open(channel) {
    this.channel = channel;
    this.start = null;
  }

  /** Energies of a sample [J]. */
  energies(row) {
    const of = (name) => row[this.channel(`energy_${name}`).at];
    return Object.fromEntries(['supplied', 'dissipated', 'kinetic', 'stored', 'residual'].map((it) => [it, of(it)]));
  }

  /** Keeps the energies of the first sample, from which the motion is counted. */
  take(rows) {
    if (!this.start && rows.length) this.start = this.energies(rows);
  }

  draw(history) {
    if (!history?.last || !this.start) return;
    const now = this.energies(history.last);
    for (const store of ['kinetic', 'stored']) now[store] -= this.start[store];
    LEDGER.forEach(([, value], i) => {
      this.cells[i].textContent = quantity(value(now), 'J');
    });
    const turned = Math.max(Math.abs(now.supplied), Math.abs(now.dissipated), Math.abs(now.kinetic), Math.abs(now.stored));
    const share = turned > 0 ? Math.abs(now.residual) / turned : 0;
    byId('share').textContent = turned > 0
      ? `The ledger closes to ${share < 1e-6 ? 'less than a millionth' : percent(share)} of what was turned over.`
      : 'Nothing has been turned over yet.';
    byId('share').className = share > 0.01 ? 'distrusted' : share > 1e-3 ? 'caution' : '';
  }
}

/** A share in per cent. */
const percent = (share) => `${withMinus(+(100 * share).toPrecision(2))} %`;

/** Tells how the motion is stepped. */
function tellStepping({ method, step, steps, rejections }) {
  const how = step ? `steps of ${quantity(step, 's')}` : 'steps under error control';
  const again = rejections ? `, ${rejections.toLocaleString('en')} taken again` : '';
  byId('stepping').textContent = `${method}, ${how}; ${steps.toLocaleString('en')} steps${again}.`;
}
