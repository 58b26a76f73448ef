import type { MeshFormat, Report } from './index.js';
import type { View } from './view.js';

/**
 * The element `<marching-particles>`. Its attributes are properties, too. It tells of `progress`, of
 * the `report` and of an `error` by events with a `detail`, and samples once it comes into sight.
 */
export class MarchingParticles extends HTMLElement {
  formula: string | null;
  /** a surface of the gallery, such as `gyroid` */
  surface: string | null;
  /** values of parameters, as in `a=0.5, b=2` */
  params: string | null;
  count: string | null;
  /** half of the distance between neighbours, as a share of the box diagonal */
  radius: string | null;
  method: string | null;
  seed: string | null;
  adaptive: boolean;
  /** what the colours mean, such as `level`, `normal` or `curvature` */
  colour: string | null;
  /** `discs`, `spheres` or `mesh` */
  draw: string | null;
  /** `auto`, `light` or `dark` */
  theme: string | null;
  /** `webgpu`, `webgl2` or `canvas2d`: what is to draw the picture; read when it comes into sight */
  backend: string | null;
  /** whether pointer and keys turn the picture and zoom in it; it can then have the focus */
  controls: boolean;
  readonly view: View | null;
  readonly report: Report | null;
  toFile(format: MeshFormat): Promise<Uint8Array<ArrayBuffer>>;
}

declare global {
  interface HTMLElementTagNameMap {
    'marching-particles': MarchingParticles;
  }
}
