// A module of the core, as the package is built: its bytes.
declare module '*_bg.wasm' {
  const bytes: Uint8Array;
  export default bytes;
}
