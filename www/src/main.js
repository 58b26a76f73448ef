/** The page: an engine, and the interface over it. */
import './ui/trusted.js';
import { createEngine } from './engine/index.js';
import { byId } from './ui/dom.js';
import { mountInterface } from './ui/app.js';

mountInterface(createEngine({ canvasHost: byId('canvas-host') }));
