// The core: a module that is unpacked once, in workers that are made of texts of this page.

/** Bytes of base64 text. */
function bytesOf(text) {
  const binary = atob(text);
  return Uint8Array.from(binary, (it) => it.charCodeAt(0));
}

/** Passes bytes through a stream of the browser, and gives what comes out. */
async function through(bytes, stream) {
  return new Uint8Array(await new Response(new Blob([bytes]).stream().pipeThrough(stream)).arrayBuffer());
}

/** The module of the page. */
async function readModule() {
  const packed = bytesOf(byId('module').textContent.trim());
  return WebAssembly.compile(await through(packed, new DecompressionStream('deflate-raw')));
}

/** A mistake that the core tells; `problems` are those of a scene, `ended` that the worker is of no more use. */
class CoreError extends Error {
  constructor({ message, problems, ended }) {
    super(message);
    Object.assign(this, { problems, ended });
  }
}

/** A worker with the module: `ask` it, and `end` it whatever it does. */
class Core {
  constructor(module, told = {}) {
    // A page from a disk may load no other file: the worker is a text of this one.
    const program = `${byId('glue').textContent}\n${byId('worker').textContent}`;
    this.address = URL.createObjectURL(new Blob([program], { type: 'text/javascript' }));
    this.worker = new Worker(this.address);
    this.told = told;
    this.asked = new Map();
    this.count = 0;
    this.worker.onmessage = ({ data }) => this.take(data);
    this.worker.onerror = (event) => this.fail(new CoreError({ message: event.message || 'the worker cannot be started', ended: true }));
    this.worker.postMessage({ module });
  }

  ask(what, given) {
    if (!this.worker) return Promise.reject(new CoreError({ message: 'stopped', ended: true }));
    this.count += 1;
    const id = this.count;
    return new Promise((resolve, reject) => {
      this.asked.set(id, { resolve, reject });
      this.worker.postMessage({ id, what, given });
    });
  }

  take({ id, answer, error, progress }) {
    if (progress !== undefined) this.told.progress?.(progress);
    const question = this.asked.get(id);
    if (!question) return;
    this.asked.delete(id);
    if (error?.ended) {
      question.reject(new CoreError(error));
      this.fail(new CoreError(error));
    } else if (error) question.reject(new CoreError(error));
    else question.resolve(answer);
  }

  /** Ends the worker and tells whoever waits. */
  fail(error) {
    this.end(error);
    this.told.ended?.(error);
  }

  end(error = new CoreError({ message: 'stopped', ended: true })) {
    this.worker?.terminate();
    this.worker = null;
    URL.revokeObjectURL(this.address);
    for (const { reject } of this.asked.values()) reject(error);
    this.asked.clear();
  }
}
