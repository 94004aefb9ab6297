// A change that opens the loop, such as another number of teeth: which links and which wheel close it again.

/** How far a wheel may go to close a loop, either way [pitches]. */
const CLOSING_REACH = 5;

/** Numbers of links that are tried on either side. */
const LINKS_TRIED = 16;

/** Changes after which a loop may have to be closed. */
const CLOSED_BY = /\.(teeth|links|elongation)$/;

/** Whether all chains of a scene that was read close, but for what strain takes up. */
const closes = ({ layout }) => list(layout).every(({ misfit, pitch }) => Math.abs(misfit ?? 0) < 0.02 * pitch);

/** Reads a scene with changes of which one is at `path`; where its chain does not close then, with another number of links, and a wheel moved. */
async function readClosed(core, base, changes, path) {
  const read = (more = []) => core.ask('read', { ...base, changes: [...changes, ...more] });
  const about = await read().catch((error) => {
    if (error.ended || !path.endsWith('.teeth')) throw error;
    return firstThat(linksNear(changes, base), (links) => read([['chain.links', links]])).then((found) => {
      if (!found) throw error;
      return { ...found.answer, also: [['chain.links', found.tried]] };
    });
  });
  if (about.also) return { about, also: about.also, note: `with ${about.resolved.chain.links} links` };
  // A worn chain is laid as it was new, and closes with links that are longer.
  const isWorn = path.endsWith('.elongation') && about.resolved.chain?.elongation > 0;
  if ((closes(about) && !isWorn) || !CLOSED_BY.test(path) || !about.resolved.chain) return { about, also: [], note: '' };

  const facts = factsOf(about);
  const [{ counts, pitch }] = about.layout;
  const nearest = counts.pitches - counts.even_below < counts.even_above - counts.pitches ? counts.even_below : counts.even_above;
  const links = path.endsWith('.teeth') ? [['chain.links', nearest]] : [];
  const found = await firstThat(closers(facts), async ({ name, direction }) => {
    const adjust = { kind: 'sprocket', name, direction, within: CLOSING_REACH * pitch };
    const also = [...links, ['route.adjust', adjust]];
    const closed = await read(also);
    if (!closes(closed)) throw new Error('it does not reach');
    return { closed, also };
  });
  if (!found) return { about, also: [], note: '' };
  const { closed, also } = found.answer;
  const travel = Math.abs(closed.layout[0].travel ?? 0);
  const note = `with ${closed.resolved.chain.links} links; ${found.tried.name} moved by ${(1e3 * travel).toFixed(1)} mm, which closes the loop`;
  return { about: closed, also, note };
}

/** Numbers of links, even ones first, the nearest of them first. */
function linksNear(changes, base) {
  const now = changes.find(([path]) => path === 'chain.links')?.[1] ?? base.links;
  const all = Array.from({ length: 2 * LINKS_TRIED + 1 }, (_, i) => now - LINKS_TRIED + i);
  return all.sort((a, b) => (a % 2) - (b % 2) || Math.abs(a - now) - Math.abs(b - now));
}

/** The first of some tries that succeeds, with its answer; null where none does. */
async function firstThat(tries, ask) {
  for (const tried of tries) {
    try {
      return { tried, answer: await ask(tried) };
    } catch (error) {
      if (error.ended) throw error;
    }
  }
  return null;
}

/** Wheels that may close a loop, each with the direction in which it tightens the chain: idlers first, then what is loaded. */
function closers({ sprockets, driver }) {
  const fixed = sprockets.filter((it) => it !== driver && (it.support?.kind ?? 'fixed') === 'fixed');
  const idles = (it) => list(it.shaft?.load).length === 0;
  const sorted = [...fixed.filter(idles), ...fixed.filter((it) => !idles(it))];
  return sorted.map((it) => {
    const rest = sprockets.filter((other) => other !== it);
    const away = [0, 1].map((axis) => it.centre[axis] - rest.reduce((sum, other) => sum + other.centre[axis], 0) / rest.length);
    const length = Math.hypot(...away) || 1;
    return { name: it.name, direction: away.map((value) => (it.sign * value) / length) };
  });
}
