/** The cutting plane as WebGL2 draws it. */
import { suite } from './plane-suite.js';

suite();
