/** The mesh as WebGL2 draws it. */
import { suite } from './mesh-suite.js';

suite();
