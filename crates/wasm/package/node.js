// The module for Node: read from the folder of the package, ready when it is imported.

import { readFileSync } from 'node:fs';
import { initSync } from './index.js';

initSync({ module: readFileSync(new URL('./index_bg.wasm', import.meta.url)) });

export * from './index.js';

/** There is nothing to wait for in Node; here so that one text serves both. */
export default async function ready() {}
