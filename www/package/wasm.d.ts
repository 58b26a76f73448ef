// A module of the core, as its bytes, when the package is built.
declare module '*_bg.wasm' {
  const bytes: Uint8Array;
  export default bytes;
}
