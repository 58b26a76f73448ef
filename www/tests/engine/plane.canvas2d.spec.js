/** The cutting plane as the 2-D canvas draws it. */
import { suite } from './plane-suite.js';

suite({ mesh: false });
