// What the probe finds.

/** Who draws WebGL2: a graphics card, a program in its place, or nobody; null if that cannot be told. */
export type Drawer = 'card' | 'software' | 'none' | null;
