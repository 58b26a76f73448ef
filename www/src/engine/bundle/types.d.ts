// The part of a worker that the engine's clients use.

/** A function that takes an event; written as a method, so that a handler of a worker's own events is one, too. */
type Handler<E> = { handle(event: E): void }['handle'];
/** The part of a worker that its client uses. Tests pass a scripted one. */
export interface WorkerLike<Sent, Heard> {
  postMessage(message: Sent): void;
  terminate(): void;
  onmessage: Handler<{ data: Heard }> | null;
  onerror: Handler<{ message?: string }> | null;
}

export interface RequestWorkerOptions<Sent, Heard> {
  spawn: () => WorkerLike<Sent, Heard>;
  onMessage: (message: Heard) => void;
  /** an error that the worker has not caught, in words or without */
  onFail: (message: string) => void;
}

/** Why a bundle could not be loaded. */
export type LoadFault = 'missing' | 'blocked' | 'corrupt' | 'no_simd' | 'no_wasm' | 'init';
/** The surroundings of a worker's loop, which tests script. */
export interface WorkerEnv<Message> {
  nowMs: () => number;
  /** lets the worker handle its messages */
  pause: () => Promise<void>;
  post: (message: Message, transfer?: Transferable[]) => void;
}
/** The surroundings of work in slices. */
export interface SliceEnv<Why extends string = never> {
  nowMs: () => number;
  /** lets the thread handle its messages */
  pause: () => Promise<void>;
  /** why the work ends before the next slice; null if it continues */
  interrupt?: () => Why | null;
}
/** A timer of the browser, or a number of a test's clock. */
export type Timer = ReturnType<typeof setTimeout> | number;
export interface Timers {
  setTimeout: (f: () => void, ms: number) => Timer;
  clearTimeout: (id: Timer | undefined) => void;
}
