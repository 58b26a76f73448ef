// What the engine's clients know of their workers.

/** A function that takes an event; written as a method, so that a handler of a worker's own events is one, too. */
type Handler<E> = { handle(event: E): void }['handle'];
/** The part of a worker that its client uses. Tests pass a scripted one. */
export interface WorkerLike<Sent, Heard> {
  postMessage(message: Sent): void;
  terminate(): void;
  onmessage: Handler<{ data: Heard }> | null;
  onerror: Handler<{ message?: string }> | null;
}
