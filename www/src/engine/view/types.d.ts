// Types of the picture: its devices, its camera, its colours and what the pointer does to it.
import type { Renderer } from '../../wasm/render-webgpu/render.js';
import type {
  BackendKind,
  Bounds,
  CameraState,
  Columns,
  CuttingPlane,
  Legend,
  Reveal,
  Take,
  Vec3,
  ViewState,
} from '../types.js';
import type { openDevice } from './backends.js';
import type { Camera } from './camera.js';
import type { Painter } from './painter.js';
import type { palette } from './palettes.js';

export interface Device {
  kind: BackendKind;
  canvas: HTMLCanvasElement;
  renderer: Renderer | Painter;
  dispose: () => void;
}
export type Insets = import('../types.js').Insets;
export type Ball = { centre: Vec3; radius: number };
/** A picture from an eye: its matrices and vectors, and its size in CSS pixels. */
export type View = {
  widthPx: number;
  heightPx: number;
  clipFromWorld: Float32Array;
  eye: Vec3;
  forward: Vec3;
  right: Vec3;
  up: Vec3;
  tanX: number;
  tanY: number;
  shiftX: number;
  shiftY: number;
  /** length across a pixel at distance 1 from the eye */
  worldPerPx: number;
  /** distance of the target from the eye */
  span: number;
  parallel: boolean;
  packed: Float32Array;
};
/** A way to colour the particles. A colour is packed as `0xAABBGGRR`. */
export interface Colouring {
  /** whether light may tint the colours, because no value is read from them */
  isTinted?: boolean;
  /** the values at both ends of a ramp, where they depend on the particles; null before there is a value */
  range?: (columns: Columns) => [number, number] | null;
  /** null while what it shows is not known */
  colour: (context: Context) => ((i: number) => number) | null;
  legend: (context: Context) => Omit<Legend, 'unit'> & { unit?: string };
}
/**
 * The outcome of a frame. `skipped`: the screen did not accept the picture; `none`: there was no device or no visible
 * canvas.
 */
/** `part`: the next frame goes on with the same picture. */
export type FrameResult = 'drawn' | 'part' | 'skipped' | 'none';
export interface Style {
  /** the faces of a mesh in place of its particles, null for discs or spheres */
  faces?: { flat: boolean; edge_px: number } | null;
  spheres?: boolean;
  /** canvas pixels per page pixel */
  pixel_ratio?: number;
  /** sRGB 0 … 1 */
  background: [number, number, number, number];
  disc_scale: number;
  key_light_view: [number, number, number];
  dim: number;
  /** share by which discs seen from behind are drawn as an inside, darker and greyer */
  dim_backfaces: number;
  /** the body beneath the discs, null for none */
  body?: { colour: number[]; is_open: boolean; bounds: Bounds } | null;
  /** difference in warmth between lit and shaded places, 0 … 1 */
  warmth?: number;
  fade_s?: number;
  /** newest generation level drawn, null for all */
  level?: number | null;
  /** index of the highlighted particle, −1 for none */
  outline: number;
  box: { min: number[]; max: number[]; colour: number[] } | null;
  /** discs whose centres are beyond it are hidden */
  plane?: CuttingPlane | null;
}
/** A disc on the screen, in pixels. */
export interface PaintedDisc {
  /** its centre and its longer half axis */
  sx: number;
  sy: number;
  px: number;
  /** slopes of its plane to the right and down */
  ka: number;
  kb: number;
  /** depth at the centre */
  near: number;
  depthPerPx: number;
  /** colour within the squared distance `coreSq` from the centre; beyond it the disc has the colour of its rim */
  value: number;
  rim: number;
  coreSq: number;
}
/**
 * How much of a picture is drawn: the share of the pixels of each side, whether the body is, and one of how many
 * particles.
 */
export type Quality = { share: number; body: boolean; stride: number };
/** A ball on the screen, in pixels. */
export interface PaintedBall {
  sx: number;
  sy: number;
  px: number;
  /** depth of its centre */
  near: number;
  depthPerPx: number;
  /** light on the places of a grid over its outline, three components each */
  lights: Float32Array;
  ground: number[];
  /** share by which it fades to the ground */
  away: number;
}
/** A triangle on the screen, in pixels: of each corner the place, the depth, and the colour in linear light. */
export interface PaintedTriangle {
  x: Float64Array;
  y: Float64Array;
  near: Float64Array;
  colours: Float64Array;
  /** width of the lines along its sides; of the side opposite to each corner the share of its line, and its height */
  linePx: number;
  drawn: Float64Array;
  heights: Float64Array;
  /** of each corner how far it is beyond the cutting plane; null without one */
  beyond: Float64Array | null;
}
/** The columns of the corners of faces, but for their colours. */
export interface CornerColumns {
  positions: Float32Array;
  normals: Float32Array;
  radii: Float32Array;
  levels: Uint32Array;
}
/** The pixels of a picture and how near each is. */
export type Target = { out: Uint32Array; depth: Float32Array; width: number; height: number };
/** What the discs of a picture have in common. */
export interface PaintedScene {
  target: Target;
  axes: { right: number[]; up: number[]; forward: number[]; clipXPerWorld: number };
  /** direction to the light */
  key: number[];
  /** the background in linear light */
  ground: number[];
  /** light along the outline */
  rim: number;
  /** colour of the body in linear light; empty without one */
  bed: number[];
  /** factor of all radii */
  swell: number;
  /** light on a sphere, where particles are drawn as spheres */
  lights: Float32Array | null;
}
/** A picture that the painter has begun. */
export interface Pass {
  scene: PaintedScene;
  target: Target;
  timeS: number;
  /** the background in linear light, and as a pixel */
  ground: number[];
  value: number;
  /** number of samples, and the one that is being painted */
  samples: number;
  sample: number;
  /** numbers of faces, of discs of the body, of particles and of marks */
  faces: number;
  beds: number;
  discs: number;
  marks: number;
  /** the first particle that no face stands for */
  first: number;
  /** what is painted next, counted over faces, body, particles and marks */
  next: number;
}
export type Theme = 'light' | 'dark';
export type Palette = ReturnType<typeof palette>;
/** in CSS pixels of the host */
export type Place = { x: number; y: number };
/** The objects on which the pointers act. */
export interface Stage {
  host: HTMLElement;
  camera: Camera;
  currentView: () => View;
  moved: () => void;
  fit: () => void;
  /** the pointer hovers over or tapped this place */
  point: (x: number, y: number, tapped: boolean) => void;
  /** where the target of the camera is */
  centre: () => Place | null;
  /** the pointer left, or was `pressed` */
  leave: (pressed: boolean) => void;
  take: Take;
}
/** The options of the view that the picture shows, and the rest of what it shows. */
export type Look = Omit<ViewState, 'theme' | 'box' | 'bar' | 'measured' | 'points' | 'camera'> & Setting;
export interface Setting {
  theme: 'light' | 'dark';
  /** the clip box, or null if it is not drawn */
  box: Bounds | null;
  /** what it hides is neither drawn nor picked */
  plane: CuttingPlane | null;
  /** the points of a model, three numbers each, drawn as dots */
  points: Float32Array | null;
  /** index of the particle with an outline, −1 for none */
  highlight: number;
  insets: Insets;
}
/** The events of the viewer. */
export interface ViewerEvents {
  onDevice: (device: Device) => void;
  onLost: (kind: string, message: string) => void;
  onFallback: DeviceOptions['onFallback'];
  onLegend: (legend: Legend) => void;
  onCamera: (camera: CameraState) => void;
  /** a picture was drawn */
  onFrame: () => void;
  onReveal: (reveal: Reveal | null) => void;
}
/** The input of a colouring. */
export type Context = { palette: Palette; columns: Columns; range: [number, number] | null };
/** The particles that {@link pick} sees. */
export interface PickOptions {
  /** disc radius as a share of the particle's radius */
  discScale: number;
  /** whether they are drawn as spheres */
  spheres?: boolean;
  /** angle around the ray within which a disc that is too small to hit is found */
  toleranceRad: number;
  /** particles of later levels are hidden */
  lastLevel?: number;
  /** particles beyond it are hidden */
  plane?: CuttingPlane | null;
}
export interface DeviceOptions {
  host: HTMLElement;
  /** a new device, without particles, is open; `isStandIn`: until the first one of the kind that is wanted is there */
  onOpen: (device: Device, isStandIn: boolean) => void;
  /** the device is lost and another is being opened */
  onLost: (kind: BackendKind, message: string) => void;
  /** a kind of device was abandoned, with `isLate` because it took too long to open */
  onFallback: (kind: BackendKind, message: string, isLate?: boolean) => void;
  /** kind to try first; without it the machine decides */
  first?: BackendKind | null;
  /** tells which kind this machine draws best with */
  probe?: () => Promise<BackendKind>;
  open?: typeof openDevice;
  clock?: { now: () => number; wait: (ms: number) => Promise<void> };
}
export interface DotOptions {
  /** canvas pixels per page pixel */
  px: number;
  /** disc scale of the renderer, which the radii compensate */
  size: number;
  /** distance by which a dot is moved towards the eye, in front of the discs around it */
  lift: number;
  palette: { ink: number; casing: number };
}
export interface ViewerOptions {
  host: HTMLElement;
  columns: Columns;
  look: ViewState;
  /** the back end to try first */
  first: BackendKind | null;
}
