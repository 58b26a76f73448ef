/** The generation levels as WebGPU draws them. */
import { suite } from './levels-suite.js';

suite();
