/** The cutting plane as WebGPU draws it. */
import { suite } from './plane-suite.js';

suite();
