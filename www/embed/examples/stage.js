// What three.js needs around an object: a light, a camera that fits it, and a canvas in an element.
import { Box3, DirectionalLight, HemisphereLight, PerspectiveCamera, Scene, Sphere, WebGLRenderer } from 'three';

/**
 * After so many slow frames in a row it stands still: without a graphics card the page would hardly
 * answer.
 */
const SLOW_FRAMES = 5;
const SLOW_MS = 80;
/** Largest turn of a frame, in radians. */
const MOST_STEP = 0.05;

/** @param {string} id  of the element @param {import('three').Object3D} object */
export function show(id, object) {
  const host = document.getElementById(id);
  if (!host) return;
  const renderer = new WebGLRenderer({ antialias: true, alpha: true });
  renderer.setPixelRatio(devicePixelRatio);
  host.replaceChildren(renderer.domElement);

  const scene = new Scene();
  const light = new DirectionalLight(0xffffff, 2.2);
  light.position.set(-1, -2, 3);
  scene.add(object, new HemisphereLight(0xffffff, 0x667788, 1.6), light);
  const { center, radius } = new Box3().setFromObject(object).getBoundingSphere(new Sphere());
  const camera = new PerspectiveCamera(35, 1, 0.1 * radius, 10 * radius);
  camera.up.set(0, 0, 1);

  let angle = 0.6;
  function draw() {
    camera.position
      .set(Math.cos(angle), Math.sin(angle), 0.55)
      .multiplyScalar(2.8 * radius)
      .add(center);
    camera.lookAt(center);
    renderer.render(scene, camera);
  }
  new ResizeObserver(() => {
    renderer.setSize(host.clientWidth, host.clientHeight);
    camera.aspect = host.clientWidth / host.clientHeight;
    camera.updateProjectionMatrix();
    draw();
  }).observe(host);
  // Seen from all around, or from one side for those who ask for less motion.
  if (matchMedia('(prefers-reduced-motion: reduce)').matches) return;
  let lastMs = Infinity;
  let slow = 0;
  function turn(/** @type {number} */ ms) {
    slow = ms - lastMs > SLOW_MS ? slow + 1 : 0;
    angle += Math.min(MOST_STEP, Math.max(0, ms - lastMs) / 6000);
    lastMs = ms;
    draw();
    if (slow < SLOW_FRAMES) return;
    sight.disconnect();
    renderer.setAnimationLoop(null);
  }
  // What nobody sees stands still.
  const sight = new IntersectionObserver((entries) => {
    lastMs = Infinity;
    renderer.setAnimationLoop(entries.at(-1)?.isIntersecting ? turn : null);
  });
  sight.observe(host);
}
