/** The generation levels as the 2-D canvas draws them. */
import { suite } from './levels-suite.js';

suite();
