/**
 * Serves the built site for the browser tests at `/` and again at `/sub/path/`, as a plain static host would: the folder
 * that SITE names, else `dist/`. At `/faults/` its workers run `faults.js` first, and listen to the channel `faults`.
 *
 * Usage: node tests/server.js [port]
 */
import { existsSync, readFileSync, statSync } from 'node:fs';
import { createServer } from 'node:http';
import { extname, join, normalize } from 'node:path';
import { fileURLToPath, pathToFileURL } from 'node:url';

const root = join(process.env.SITE ?? fileURLToPath(new URL('../../dist', import.meta.url)), '/');

/** @type {Record<string, string>} */
const types = {
  '.html': 'text/html; charset=utf-8',
  '.js': 'text/javascript',
  '.css': 'text/css',
  '.wasm': 'application/wasm',
  '.svg': 'image/svg+xml',
  '.png': 'image/png',
  '.webp': 'image/webp',
  '.avif': 'image/avif',
  '.json': 'application/json',
  '.woff2': 'font/woff2',
  '.txt': 'text/plain',
  '.webmanifest': 'application/manifest+json',
};

const FAULTS = `${readFileSync(new URL('./faults.js', import.meta.url), 'utf8')}
new BroadcastChannel('faults').onmessage = ({ data }) => strike(data);
`;

/**
 * Creates a server of the site.
 * @param {(name: string, content: Buffer) => Buffer | string} [change]  what is sent for a file, by its path in the
 *   site
 */
export const createSite = (change = (_name, content) => content) =>
  createServer((request, response) => {
    const { pathname } = new URL(request.url ?? '/', 'http://localhost');
    const [mount = '/'] = ['/sub/path/', '/faults/'].filter((path) => pathname.startsWith(path));
    const inside = pathname.slice(mount.length - 1);
    let file = join(root, normalize(decodeURIComponent(inside)));
    if (!file.startsWith(root)) return response.writeHead(403).end();
    if (existsSync(file) && statSync(file).isDirectory()) file = join(file, 'index.html');
    if (!existsSync(file)) return response.writeHead(404, { 'content-type': 'text/plain' }).end('not found');
    response.writeHead(200, {
      'content-type': types[extname(file)] ?? 'application/octet-stream',
      'cache-control': 'no-store',
    });
    const name = file.slice(root.length);
    const content = change(name, readFileSync(file));
    return response.end(mount === '/faults/' && /worker-[^/]*\.js$/.test(name) ? FAULTS + content : content);
  });

if (import.meta.url === pathToFileURL(process.argv[1]).href)
  createSite().listen(Number(process.argv[2] ?? 4517), 'localhost');
