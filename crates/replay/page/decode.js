// The numbers of the film: base64, deflate, byte planes, differences, quanta.

/** Inflates one stream. */
async function inflate(bytes) {
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream('deflate-raw'));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}

/** Whole numbers of a stream, one column after the other: those of one roller stand together. */
function wholeNumbers(bytes, { rows, columns, planes, order }) {
  const count = rows * columns;
  const whole = new Int32Array(count);
  for (let i = 0; i < count; i++) {
    let zigzag = bytes[i];
    for (let plane = 1; plane < planes; plane++) zigzag |= bytes[plane * count + i] << (8 * plane);
    whole[i] = (zigzag >>> 1) ^ -(zigzag & 1);
  }
  const [inTime, across] = order;
  for (let pass = 0; pass < inTime; pass++) {
    for (let column = 0; column < columns; column++) {
      for (let i = column * rows + 1; i < (column + 1) * rows; i++) whole[i] += whole[i - 1];
    }
  }
  for (let pass = 0; pass < across; pass++) {
    for (let i = rows; i < count; i++) whole[i] += whole[i - rows];
  }
  return whole;
}

/** One array of the film: `at(row, column)` is its value in SI units. */
class Numbers {
  constructor(stream, bytes) {
    const { rows, columns, quantum, origin, missing } = stream;
    Object.assign(this, { rows, columns, quantum, origin, missing });
    this.whole = wholeNumbers(bytes, stream);
  }

  value(whole) {
    return whole === this.missing ? NaN : this.origin + this.quantum * whole;
  }

  at(row, column) {
    return this.value(this.whole[column * this.rows + row]);
  }

  /** All values, one column after the other. */
  get values() {
    this.all ??= Float64Array.from(this.whole, (whole) => this.value(whole));
    return this.all;
  }

  /** All values of one column. */
  column(column) {
    return this.values.subarray(column * this.rows, (column + 1) * this.rows);
  }

  /** Least and largest value. */
  range() {
    let [least, most] = [Infinity, -Infinity];
    for (const whole of this.whole) {
      if (whole === this.missing) continue;
      if (whole < least) least = whole;
      if (whole > most) most = whole;
    }
    return [this.value(least), this.value(most)];
  }

  /** Ends of a scale: all but one in a thousand of some values, evenly over all, lie between them. */
  scaleRange() {
    const { whole } = this;
    const stride = Math.max(1, Math.floor(whole.length / 20000));
    const some = [];
    for (let i = 0; i < whole.length; i += stride) {
      if (whole[i] !== this.missing) some.push(whole[i]);
    }
    if (!some.length) return [0, 0];
    const sorted = Int32Array.from(some).sort();
    const last = sorted.length - 1;
    const end = (share) => this.value(sorted[Math.round(share * last)]);
    return [Math.min(0, end(0.001)), end(0.999)];
  }
}

/** The whole film, read from the page. */
async function readFilm() {
  const film = JSON.parse(document.getElementById('index').textContent);
  const text = atob(document.getElementById('data').textContent.trim());
  const packed = new Uint8Array(text.length);
  for (let i = 0; i < text.length; i++) packed[i] = text.charCodeAt(i);
  film.arrays = {};
  await Promise.all(film.streams.map(async (stream) => {
    const bytes = await inflate(packed.subarray(stream.at, stream.at + stream.length));
    film.arrays[stream.name] = new Numbers(stream, bytes);
  }));
  film.frames = film.arrays.time.rows;

  // Lines of the bodies, in their own frames.
  const { outline_x: x, outline_y: y } = film.arrays;
  let corner = 0;
  for (const body of film.bodies) {
    body.lines = body.outlines.map(([count, closed]) => {
      const points = [];
      for (let i = 0; i < count; i++, corner++) points.push([x.at(corner, 0), y.at(corner, 0)]);
      return { points, closed };
    });
  }

  placeChains(film);
  return film;
}
