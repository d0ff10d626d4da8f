"use strict";
// Vega's packages are CommonJS modules; each is run once, when first required.
const vdwmeshModules = {};
function vdwmeshModule(name, body) {
  vdwmeshModules[name] = { body, exports: null };
}
function vdwmeshRequire(name) {
  // vega-functions asks for the package vega-selection by its former name.
  const found = vdwmeshModules[name === "vega-selections" ? "vega-selection" : name];
  if (!found) throw new Error("no module " + name);
  if (!found.exports) {
    const module = { exports: {} };
    found.exports = module.exports;
    found.body.call(globalThis, module.exports, vdwmeshRequire, module);
    found.exports = module.exports;
  }
  return found.exports;
}
