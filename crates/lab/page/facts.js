// What the page has to know of a drive: shafts that turn, loads, what can be changed. Everything in SI units.

/** Turns a minute in a radian a second. */
const RPM = 30 / Math.PI;

/** A list that a scene may leave out. */
const list = (value) => value ?? [];

/** Mean speed of a motion [rad/s]; none where it has no steady one. */
function meanSpeed(motion) {
  if (!motion) return null;
  const speed = motion.kind === 'ramp' ? motion.to : motion.speed;
  return Number.isFinite(speed) && speed !== 0 ? speed : null;
}

/** Mean of torques that act on a shaft [N m], as far as they have one by themselves. */
function meanTorque(torques) {
  const means = torques.map((it) => {
    if (it.kind === 'constant' || it.kind === 'ramp') return it.torque;
    if (it.kind !== 'angle-table') return 0;
    // Trapezoids over the angle.
    let [sum, all] = [0, 0];
    for (let i = 1; i < it.angles.length; i++) {
      const wide = it.angles[i] - it.angles[i - 1];
      sum += 0.5 * wide * (it.torques[i] + it.torques[i - 1]);
      all += wide;
    }
    return sum / (all || 1);
  });
  return means.reduce((sum, it) => sum + it, 0);
}

/** Shafts of a scene: those with a name, and one for every other sprocket. */
function shaftsOf(scene) {
  const named = list(scene.shafts).map((it) => ({ ...it, place: `shafts.${it.name}`, carries: list(it.sprockets) }));
  const carried = new Set(named.flatMap((it) => it.carries));
  const own = list(scene.sprockets).filter((it) => !carried.has(it.name));
  return [...named, ...own.map((it) => ({ ...it, place: `sprockets.${it.name}`, carries: [it.name] }))];
}

/** Facts of a scene that was read: with every default written out, and how its chains lie. */
function factsOf({ resolved: scene, layout, tunables }) {
  const shafts = shaftsOf(scene);
  const sprockets = list(scene.sprockets).map((it) => {
    const shaft = shafts.find((on) => on.carries.includes(it.name));
    return { ...it, shaft, sign: it.side === 'right' ? -1 : 1 };
  });
  const chains = scene.chain ? [{ ...scene.chain, route: scene.route }] : list(scene.chains);
  const driver = sprockets.find((it) => meanSpeed(it.shaft?.motion) !== null)
    ?? sprockets.find((it) => Number.isFinite(it.shaft?.speed) && it.shaft.speed !== 0);
  const speed = driver ? meanSpeed(driver.shaft.motion) ?? driver.shaft.speed : 0;
  // A pitch passes in T = 2π/(z |ω|).
  const mesh = driver ? (2 * Math.PI) / (driver.teeth * Math.abs(speed)) : null;
  return { scene, tunables, layout: list(layout), shafts, sprockets, chains, driver, mesh, pitch: chains[0]?.pitch ?? 0.01 };
}

/** Samples taken while a pitch passes. */
const IN_A_PITCH = 40;

/** Time between two samples [s]. */
function sampling(facts) {
  if (facts.mesh) return facts.mesh / IN_A_PITCH;
  return facts.scene.run?.every ?? (facts.scene.run?.until ?? 1) / 2000;
}

/** Share of real time at which a pitch takes three tenths of a second, and what has no pitch a few. */
function gentlePace(facts) {
  return facts.mesh ? Math.min(1, facts.mesh / 0.3) : Math.min(1, (facts.scene.run?.until ?? 1) / 5);
}

/** Channels that the curves are made of. */
function channelsOf({ scene, sprockets }) {
  const channels = ['energy_kinetic', 'energy_stored', 'energy_dissipated', 'energy_supplied', 'energy_residual'];
  if (sprockets.length) channels.push('sprocket_speed', 'sprocket_angle');
  if (sprockets.length > 1) channels.push('span_tension');
  else channels.push('link_tension');
  if (list(scene.tensioners).length) channels.push('tensioner_position');
  return channels;
}
