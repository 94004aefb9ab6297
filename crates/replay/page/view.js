// The picture: the drive at one frame, seen through a window that can be moved and drawn closer.

/** Pixels a mark may be away from the pointer. */
const REACH = 14;

class View {
  constructor(canvas, film) {
    this.canvas = canvas;
    this.film = film;
    this.context = canvas.getContext('2d');
    this.frame = 0;
    this.followed = -1;
    this.marked = -1;
    this.shapes = film.bodies.map((body) => this.shape(body));
    // Sprockets cover the arms that carry them.
    const layer = (b) => ['sprocket', 'force', 'carrier-force'].indexOf(film.bodies[b].kind) + 1;
    const layers = [0, 1, 2, 2];
    this.backToFront = [...film.bodies.keys()].sort((a, b) => layers[layer(a)] - layers[layer(b)]);
    this.bounds = this.boundsOfAll();
    // Ends of the scale of tension [N], and the force of the longest arrow [N]; where a drive is computed they follow it.
    const { link_tension: tension, contact_force: force } = film.arrays;
    this.tension = tension && tension.scaleRange();
    this.largestForce = force ? force.scaleRange()[1] : 0;
    this.pitch = film.chains.length ? film.chains[0].pitch : 0.01;
    this.colours = palette();
    // Centre [m] and pixels a metre; none until the size of the window is known.
    this.window = null;
  }

  /** Lines of a body as paths in its own frame. */
  shape(body) {
    let radius = 0;
    const lines = body.lines.map(({ points, closed }) => {
      const path = new Path2D();
      points.forEach(([x, y], i) => {
        radius = Math.max(radius, Math.hypot(x, y));
        if (i) path.lineTo(x, y);
        else path.moveTo(x, y);
      });
      if (closed) path.closePath();
      return { path, closed };
    });
    return { lines, radius, kind: body.kind, name: body.name };
  }

  /** The part of the plane that the drive ever covers. */
  boundsOfAll() {
    const { arrays, bodies, frames, chains } = this.film;
    let [left, right, low, high] = [Infinity, -Infinity, Infinity, -Infinity];
    const take = (x, y, margin) => {
      left = Math.min(left, x - margin);
      right = Math.max(right, x + margin);
      low = Math.min(low, y - margin);
      high = Math.max(high, y + margin);
    };
    if (this.film.rollers) {
      const [x, y] = [arrays.roller_x.range(), arrays.roller_y.range()];
      const margin = Math.max(...chains.map((chain) => 0.7 * chain.pitch));
      take(x[0], y[0], margin);
      take(x[1], y[1], margin);
    }
    bodies.forEach((body, b) => {
      for (const frame of new Set([0, frames >> 1, frames - 1])) {
        const [x, y, angle] = this.placement(b, frame);
        const [cos, sin] = [Math.cos(angle), Math.sin(angle)];
        for (const { points } of body.lines) {
          for (const [u, v] of points) take(x + cos * u - sin * v, y + sin * u + cos * v, 0);
        }
      }
    });
    return { left, right, low, high };
  }

  placement(body, frame) {
    const { body_x: x, body_y: y, body_angle: angle } = this.film.arrays;
    return [x.at(frame, body), y.at(frame, body), angle.at(frame, body)];
  }

  roller(number, frame = this.frame) {
    const { roller_x: x, roller_y: y } = this.film.arrays;
    return [x.at(frame, number), y.at(frame, number)];
  }

  /** Fits the canvas to its place on the page. */
  resize() {
    const { width, height } = this.canvas.getBoundingClientRect();
    if (!width || !height) return;
    this.density = window.devicePixelRatio || 1;
    this.canvas.width = Math.round(width * this.density);
    this.canvas.height = Math.round(height * this.density);
    const fitted = !this.window || this.window.whole;
    Object.assign(this, { width, height });
    if (fitted) this.showAll();
  }

  showAll() {
    const { left, right, low, high } = this.bounds;
    // The legend and the buttons stand beside the drive where there is room, else above it.
    const [w, h] = [right - left, high - low];
    const room = (aside, above) => Math.min((this.width - aside) / w, (this.height - above) / h);
    const beside = room(2 * 190, 64);
    const under = room(36, this.width < 600 ? 56 : 2 * 92);
    const scale = Math.max(beside, under);
    this.window = { x: 0.5 * (left + right), y: 0.5 * (low + high), scale, whole: true };
    this.least = 0.2 * scale;
    this.most = Math.max(40 * scale, 400 / this.pitch);
  }

  /** Draws closer by a factor; the point under (x, y) [pixels] stays where it is. */
  zoom(factor, x = 0.5 * this.width, y = 0.5 * this.height) {
    const { window: seen } = this;
    const scale = Math.min(this.most, Math.max(this.least, seen.scale * factor));
    const [dx, dy] = [x - 0.5 * this.width, y - 0.5 * this.height];
    seen.x += dx / seen.scale - dx / scale;
    seen.y -= dy / seen.scale - dy / scale;
    Object.assign(seen, { scale, whole: false });
  }

  pan(dx, dy) {
    this.window.x -= dx / this.window.scale;
    this.window.y += dy / this.window.scale;
    this.window.whole = false;
    this.followed = -1;
  }

  /** Starts to follow a roller, close enough to see it. */
  follow(roller) {
    this.followed = roller;
    if (roller < 0) return;
    const close = 46 / this.pitch;
    if (this.window.scale < close) this.window.scale = close;
    this.window.whole = false;
  }

  /** Moves the window to a roller that it does not show. */
  bringIn(roller, frame) {
    const [x, y] = this.roller(roller, frame);
    const [u, v] = this.toScreen(x, y);
    const isIn = (at, size) => at > 2 * REACH && at < size - 2 * REACH;
    if (!isIn(u, this.width) || !isIn(v, this.height)) Object.assign(this.window, { x, y, whole: false });
  }

  toScreen(x, y) {
    const { x: cx, y: cy, scale } = this.window;
    return [0.5 * this.width + (x - cx) * scale, 0.5 * this.height - (y - cy) * scale];
  }

  /** The roller under a point of the screen, or −1. */
  rollerAt(x, y) {
    let [best, least] = [-1, Math.max(REACH, 0.5 * this.pitch * this.window.scale)];
    for (let roller = 0; roller < this.film.rollers; roller++) {
      const [u, v] = this.toScreen(...this.roller(roller));
      const distance = Math.hypot(u - x, v - y);
      if (distance < least) [best, least] = [roller, distance];
    }
    return best;
  }

  draw() {
    if (!this.window) return;
    if (this.followed >= 0) [this.window.x, this.window.y] = this.roller(this.followed);
    const { context: c, density, colours } = this;
    c.setTransform(density, 0, 0, density, 0, 0);
    c.fillStyle = colours.paper;
    c.fillRect(0, 0, this.width, this.height);
    // Seen with the near plates taken off: those behind the sprockets, rollers in front.
    this.drawPlates();
    for (const b of this.backToFront) this.drawBody(this.shapes[b], this.placement(b, this.frame));
    this.screen();
    this.drawLinks();
    this.drawRollers();
    this.drawForces();
    this.drawMarks();
    this.drawNames();
  }

  /** Back to pixels. */
  screen() {
    this.context.setTransform(this.density, 0, 0, this.density, 0, 0);
  }

  /** One path from roller to roller for every link of a chain that `wanted` accepts. */
  tracePath(chain, wanted) {
    const { context: c } = this;
    c.beginPath();
    for (let link = 0; link < chain.links; link++) {
      if (wanted && !wanted(link)) continue;
      const next = (link + 1) % chain.rollers;
      c.moveTo(...this.toScreen(...this.roller(chain.firstRoller + link)));
      c.lineTo(...this.toScreen(...this.roller(chain.firstRoller + next)));
    }
  }

  /** Step on the scale of tension of every link of a chain, at this frame. */
  tensionSteps(chain) {
    const tensions = this.film.arrays.link_tension;
    if (!tensions) return null;
    const [slack, tight] = this.tension;
    return Int8Array.from({ length: chain.links }, (_, link) => {
      const share = (tensions.at(this.frame, chain.firstLink + link) - slack) / (tight - slack || 1);
      return Math.max(0, Math.min(STEPS - 1, Math.floor(share * STEPS)));
    });
  }

  /** Strokes the links of a chain in the colours of their tension. */
  strokeByTension(chain, steps) {
    for (const step of new Set(steps)) {
      this.tracePath(chain, (link) => steps[link] === step);
      this.context.strokeStyle = this.colours.scale[step];
      this.context.stroke();
    }
  }

  drawPlates() {
    const { context: c, colours, window: { scale } } = this;
    c.lineCap = 'round';
    for (const chain of this.film.chains) {
      const height = chain.plate_height * scale;
      if (height < 5) continue;
      this.tracePath(chain);
      c.strokeStyle = colours['plate-line'];
      c.lineWidth = height;
      c.stroke();
      const steps = this.tensionSteps(chain);
      c.strokeStyle = steps ? colours.paper : colours.plate;
      c.lineWidth = height - 1.6;
      c.stroke();
      if (!steps) continue;
      // Pale, so that rollers and arrows stand out.
      c.globalAlpha = 0.5;
      this.strokeByTension(chain, steps);
      c.globalAlpha = 1;
    }
  }

  drawBody({ lines, kind, radius }, [x, y, angle]) {
    const { context: c, colours, density, window: { scale } } = this;
    const [u, v] = this.toScreen(x, y);
    const [cos, sin] = [Math.cos(angle) * scale * density, Math.sin(angle) * scale * density];
    c.setTransform(cos, -sin, -sin, -cos, u * density, v * density);
    const sprocket = kind === 'sprocket';
    const face = kind === 'guide';
    const force = kind.endsWith('force');
    c.lineJoin = 'round';
    c.fillStyle = sprocket ? colours.steel : colours.arm;
    c.strokeStyle = sprocket ? colours['steel-line'] : face ? colours.guide : force ? colours.force : colours['arm-line'];
    c.lineWidth = (face || force ? 2.6 : 1.1) / scale;
    for (const { path, closed } of lines) {
      if (closed) c.fill(path);
      // The material behind a face is for the eye; the face is what the chain meets.
      if (!(face && closed)) c.stroke(path);
    }
    if (!sprocket) return;
    // Bore, and a mark by which one sees it turn.
    c.lineWidth = 1 / scale;
    c.fillStyle = colours.paper;
    c.beginPath();
    c.arc(0, 0, 0.16 * radius, 0, 2 * Math.PI);
    c.fill();
    c.stroke();
    c.fillStyle = colours['steel-line'];
    c.beginPath();
    c.arc(0.55 * radius, 0, 0.035 * radius, 0, 2 * Math.PI);
    c.fill();
  }

  drawLinks() {
    const { context: c, colours, window: { scale } } = this;
    c.lineCap = 'round';
    for (const chain of this.film.chains) {
      c.lineWidth = Math.max(3, Math.min(0.3 * chain.plate_height * scale, 9));
      const steps = this.tensionSteps(chain);
      if (steps) this.strokeByTension(chain, steps);
      else {
        this.tracePath(chain);
        c.strokeStyle = colours['plate-line'];
        c.stroke();
      }
    }
  }

  drawRollers() {
    const { context: c, colours, window: { scale } } = this;
    c.fillStyle = colours.roller;
    c.strokeStyle = colours.ink;
    for (const chain of this.film.chains) {
      const radius = chain.roller_radius * scale;
      if (radius < 1.2) continue;
      c.lineWidth = Math.min(1.1, 0.35 * radius);
      c.beginPath();
      for (let i = 0; i < chain.rollers; i++) {
        const [u, v] = this.toScreen(...this.roller(chain.firstRoller + i));
        c.moveTo(u + radius, v);
        c.arc(u, v, radius, 0, 2 * Math.PI);
      }
      c.fill();
      c.stroke();
    }
  }

  /** Length of the longest arrow [pixels]. */
  longest() {
    return Math.max(26, Math.min(1.6 * this.pitch * this.window.scale, 110));
  }

  drawForces() {
    const { contact_force: forces, contact_direction: directions } = this.film.arrays;
    if (!forces || !directions || !(this.largestForce > 0)) return;
    const { context: c, colours } = this;
    const longest = this.longest();
    c.strokeStyle = colours.force;
    c.lineWidth = 1.6;
    c.lineCap = 'butt';
    c.beginPath();
    for (let roller = 0; roller < this.film.rollers; roller++) {
      const length = (longest * forces.at(this.frame, roller)) / this.largestForce;
      if (!(length > 1.5)) continue;
      this.traceArrow(roller, directions.at(this.frame, roller), length);
    }
    c.stroke();
  }

  /** The path of an arrow from a roller, in a direction [rad] and of a length [pixels]; tells where its tip is. */
  traceArrow(roller, direction, length) {
    const { context: c } = this;
    const [dx, dy] = [Math.cos(direction), -Math.sin(direction)];
    const [u, v] = this.toScreen(...this.roller(roller));
    const [tipX, tipY] = [u + dx * length, v + dy * length];
    const head = Math.min(5, 0.5 * length);
    c.moveTo(u, v);
    c.lineTo(tipX, tipY);
    c.moveTo(tipX - head * (dx + 0.5 * dy), tipY - head * (dy - 0.5 * dx));
    c.lineTo(tipX, tipY);
    c.lineTo(tipX - head * (dx - 0.5 * dy), tipY - head * (dy + 0.5 * dx));
    return [tipX, tipY];
  }

  /** A ring around the roller that is followed, or that has just touched. */
  drawMarks() {
    const roller = this.followed >= 0 ? this.followed : this.marked;
    if (roller < 0) return;
    const { context: c, window: { scale } } = this;
    const [u, v] = this.toScreen(...this.roller(roller));
    c.strokeStyle = this.colours.accent;
    c.lineWidth = 2;
    c.beginPath();
    c.arc(u, v, Math.max(6, 0.42 * this.pitch * scale), 0, 2 * Math.PI);
    c.stroke();
  }

  /** Names of the bodies, as far as none covers another. */
  drawNames() {
    const { context: c, colours, window: { scale } } = this;
    c.font = '11px system-ui, "DejaVu Sans", sans-serif';
    c.textAlign = 'center';
    c.textBaseline = 'middle';
    c.fillStyle = colours.ink;
    const taken = [];
    this.shapes.forEach(({ name, kind, radius }, b) => {
      if (kind !== 'sprocket' || radius * scale < 16) return;
      const [x, y] = this.placement(b, this.frame);
      const [u, v] = this.toScreen(x, y);
      const below = v + Math.max(0.16 * radius * scale + 10, 14);
      const half = 0.5 * c.measureText(name).width + 3;
      const box = [u - half, below - 7, u + half, below + 7];
      if (half > 0.85 * radius * scale) return;
      if (taken.some((it) => box[0] < it[2] && it[0] < box[2] && box[1] < it[3] && it[1] < box[3])) return;
      taken.push(box);
      c.fillText(name, u, below);
    });
  }
}

/** Tells every chain of a film where its rollers and links begin, and counts them. */
function placeChains(film) {
  let [roller, link] = [0, 0];
  for (const chain of film.chains) {
    Object.assign(chain, { firstRoller: roller, firstLink: link });
    roller += chain.rollers;
    link += chain.links;
  }
  Object.assign(film, { rollers: roller, links: link });
}
