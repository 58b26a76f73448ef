/** The generation levels as WebGL2 draws them. */
import { suite } from './levels-suite.js';

suite();
