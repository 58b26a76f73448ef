import type { MeshFormat, Report } from './index.js';
import type { View } from './view.js';

/**
 * The element `<marching-particles>`. Its attributes are also properties. It sends the events `progress`, `report` and
 * `error`, each with a `detail`, and samples once it becomes visible.
 */
export class MarchingParticles extends HTMLElement {
  formula: string | null;
  /** a surface of the gallery, such as `gyroid` */
  surface: string | null;
  /** values of parameters, as in `a=0.5, b=2` */
  params: string | null;
  count: string | null;
  /** half of the distance between neighbours, as a share of the box diagonal such as `1%` */
  radius: string | null;
  method: string | null;
  seed: string | null;
  adaptive: boolean;
  /** meaning of the colours, such as `level`, `normal` or `curvature` */
  colour: string | null;
  /** `discs`, `spheres` or `mesh` */
  draw: string | null;
  /** `auto`, `light` or `dark` */
  theme: string | null;
  /** `webgpu`, `webgl2` or `canvas2d`: the way of drawing to use; read when the element becomes visible */
  backend: string | null;
  /** whether pointer and keys turn and zoom the picture; it can then have the focus */
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
