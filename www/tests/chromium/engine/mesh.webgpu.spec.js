/** The mesh as WebGPU draws it. */
import { suite } from './mesh-suite.js';

suite();
