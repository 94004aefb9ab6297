// Scenes that leave the page: as a file, or within a link. Nothing is sent anywhere.

/** Bytes of a scene in a link, at most: longer addresses are cut by mail programs. */
const LONGEST_LINK = 32768;

/** Hands a text over as a file. */
function save(name, text, type = 'text/plain') {
  const link = document.createElement('a');
  link.href = URL.createObjectURL(new Blob([text], { type }));
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 1000);
}

/** A name that every disk takes. */
const fileName = ({ name }) => (name || 'drive').replace(/\.toml$/, '').replace(/[^\w.-]+/g, '_').slice(0, 60) || 'drive';

/** Saves a page that plays what was seen in the last while. */
async function saveReplay(lab) {
  const page = await lab.busy('Packing the replay', lab.core.ask('replay', { title: byId('title').textContent }));
  save(`${fileName(lab.scene)}.html`, page, 'text/html');
}

/** The part of a link that holds a scene. */
async function packScene({ text, name }) {
  const bytes = new TextEncoder().encode(JSON.stringify({ name, text }));
  const packed = await through(bytes, new CompressionStream('deflate-raw'));
  let binary = '';
  for (let i = 0; i < packed.length; i += 8192) binary += String.fromCharCode(...packed.subarray(i, i + 8192));
  return btoa(binary).replaceAll('+', '-').replaceAll('/', '_').replaceAll('=', '');
}

/** Bytes of text that are read from a link at most: a small one may unfold into any amount. */
const LARGEST_SCENE = 4 << 20;

/** The scene of a link. */
async function unpackScene(packed) {
  if (packed.length > LONGEST_LINK) throw new Error('the link is longer than 32 kB');
  const bytes = bytesOf(packed.replaceAll('-', '+').replaceAll('_', '/'));
  const reader = new Blob([bytes]).stream().pipeThrough(new DecompressionStream('deflate-raw')).getReader();
  const decoder = new TextDecoder('utf-8', { fatal: true });
  let [text, size] = ['', 0];
  for (;;) {
    const { done, value } = await reader.read();
    if (done) break;
    size += value.length;
    if (size > LARGEST_SCENE) throw new Error('the scene within the link is larger than 4 MB');
    text += decoder.decode(value, { stream: true });
  }
  const { name, text: scene } = JSON.parse(text);
  if (typeof scene !== 'string') throw new Error('there is no scene in it');
  return { text: scene, name: String(name || 'scene') };
}

/** Puts the scene as it stands into the address, and the address on the clipboard. */
async function makeLink(lab) {
  const scene = await lab.sceneAsItStands();
  const packed = await packScene(scene);
  if (packed.length > LONGEST_LINK) {
    tell(`The scene takes ${Math.ceil(packed.length / 1024)} kB in a link, and 32 kB are the most: download it instead.`, 'doubt');
    return;
  }
  lab.linked = `#scene=${packed}`;
  window.location.hash = lab.linked;
  const own = window.location.protocol === 'file:';
  const copied = await navigator.clipboard?.writeText(window.location.href).then(() => true, () => false);
  const without = scene.left.length ? ` without ${scene.left.join(', ')}` : '';
  tell(`The address above holds the scene now${without}${copied ? ', and is on the clipboard' : ''}. `
    + (own ? 'This page lies on a disk: the link opens on this machine only. Send the scene or the page itself to others.'
      : 'Whoever opens it has this drive; nothing else is kept anywhere.'));
}

/** The scene that the address holds, or that was put into the page; none where neither has one. */
async function sceneOfPage() {
  const packed = /[#&]scene=([\w-]+)/.exec(window.location.hash);
  if (packed) return unpackScene(packed[1]);
  return JSON.parse(byId('scene').textContent);
}
