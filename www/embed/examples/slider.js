import 'marching-particles/element';

const slider = document.getElementById('a');
slider?.addEventListener('input', () => {
  if (slider instanceof HTMLInputElement) document.getElementById('knot')?.setAttribute('params', `a=${slider.value}`);
});
