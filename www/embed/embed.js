/**
 * Puts the examples on the page: the very files that are shown as their code, and that the tests run.
 *
 * @module
 */

/** @param {string} name */
async function textOf(name) {
  const response = await fetch(`./examples/${name}`);
  if (!response.ok) throw new Error(`examples/${name} is not on the server: it answers ${response.status}.`);
  return response.text();
}

/** @param {HTMLElement} section @param {string} text */
function addCode(section, text) {
  const code = document.createElement('pre');
  code.textContent = text.trimEnd();
  code.tabIndex = 0;
  section.append(code);
}

/** @param {HTMLElement} section */
async function fill(section) {
  const { html, script } = section.dataset;
  try {
    if (html) {
      const text = await textOf(html);
      const live = document.createElement('div');
      // Scripts in such a text do not run: the element comes with the module below.
      live.innerHTML = text;
      section.append(live);
      addCode(section, text);
    }
    if (script) addCode(section, await textOf(script));
    await import(script ? `./examples/${script}` : 'marching-particles/element');
  } catch (error) {
    const notice = document.createElement('p');
    notice.className = 'error';
    notice.textContent = error instanceof Error ? error.message : String(error);
    section.append(notice);
  }
}

async function fillAll() {
  // One after the other, so that the first is there soonest.
  for (const section of document.querySelectorAll('section')) await fill(section);
  document.body.dataset.filled = '';
}
void fillAll();
