'use strict';
// Draws the maps that the page holds. `data`: name, forward, scale, exposure, curve, facts, and textures, each a chain of cube
// levels in RGB9E5 (GL's faces, little-endian, base64) with a name for each level; dielectric is a square table of the same kind.

const data = JSON.parse(document.getElementById('data').textContent);
const element = (id) => document.getElementById(id);
const canvas = element('canvas');
const gl = canvas.getContext('webgl2', { antialias: false });
const curves = ['clip', 'reinhard', 'neutral'];
const views = ['look around', 'latlong', 'cube', 'sphere', 'paraboloid', 'angular', 'octahedral', 'equal-area'];
const textureNames = ['map', 'ggx', 'diffuse'];
const degrees = Math.PI / 180;

// All that decides what is seen. Angles in degrees: yaw from +Z towards +X, as --rotate has it.
const state = {
  view: 0, image: 0, level: 0, blur: 0.5, exposure: data.exposure, curve: curves.indexOf(data.curve), yaw: data.forward, pitch: 0, fov: 75,
  balls: [
    { x: -0.7, y: -0.45, surface: 'ggx', roughness: 0 },
    { x: 0, y: -0.45, surface: 'ggx', roughness: 0.5 },
    { x: 0.7, y: -0.45, surface: 'dielectric', roughness: 0.2 },
  ],
  ballsShown: true, ball: 1,
};
const ballRadius = 0.3;  // In half heights of the canvas.

// ---- WebGL -----------------------------------------------------------------------------------------------------------

function compiled(type, source) {
  const shader = gl.createShader(type);
  gl.shaderSource(shader, source);
  gl.compileShader(shader);
  if (!gl.getShaderParameter(shader, gl.COMPILE_STATUS)) throw new Error(gl.getShaderInfoLog(shader));
  return shader;
}

// One triangle over everything, and the shader with its uniforms by name.
function makeProgram(defines) {
  const vertex = 'void main() { gl_Position = vec4(vec2(gl_VertexID & 1, gl_VertexID >> 1) * 4.0 - 1.0, 0, 1); }';
  const program = gl.createProgram();
  gl.attachShader(program, compiled(gl.VERTEX_SHADER, `#version 300 es\n${vertex}`));
  gl.attachShader(program, compiled(gl.FRAGMENT_SHADER, `#version 300 es\n${defines}${element('shader').textContent}`));
  gl.linkProgram(program);
  if (!gl.getProgramParameter(program, gl.LINK_STATUS)) throw new Error(gl.getProgramInfoLog(program));
  return { program, at: (name) => gl.getUniformLocation(program, name) };
}

function words(base64) {
  const bytes = Uint8Array.from(atob(base64), (c) => c.charCodeAt(0));
  return new Uint32Array(bytes.buffer);
}

function makeTexture(unit, chain) {
  gl.activeTexture(gl.TEXTURE0 + unit);
  gl.bindTexture(gl.TEXTURE_CUBE_MAP, gl.createTexture());
  gl.texStorage2D(gl.TEXTURE_CUBE_MAP, chain.levels.length, gl.RGB9_E5, chain.levels[0].size, chain.levels[0].size);
  chain.levels.forEach(({ size, texels }, level) => {
    const all = words(texels ?? data.textures.map.levels[0].texels);  // GGX of roughness 0 is the map.
    for (let face = 0; face < 6; ++face)
      gl.texSubImage2D(gl.TEXTURE_CUBE_MAP_POSITIVE_X + face, level, 0, 0, size, size, gl.RGB, gl.UNSIGNED_INT_5_9_9_9_REV,
        all.subarray(face * size * size, (face + 1) * size * size));
  });
  gl.texParameteri(gl.TEXTURE_CUBE_MAP, gl.TEXTURE_MIN_FILTER, gl.LINEAR_MIPMAP_LINEAR);
  gl.texParameteri(gl.TEXTURE_CUBE_MAP, gl.TEXTURE_MAG_FILTER, gl.LINEAR);
}

function makeTable(unit, { size, texels }) {
  gl.activeTexture(gl.TEXTURE0 + unit);
  gl.bindTexture(gl.TEXTURE_2D, gl.createTexture());
  gl.texStorage2D(gl.TEXTURE_2D, 1, gl.RGB9_E5, size, size);
  gl.texSubImage2D(gl.TEXTURE_2D, 0, 0, 0, size, size, gl.RGB, gl.UNSIGNED_INT_5_9_9_9_REV, words(texels));
  for (const [name, value] of [['MIN_FILTER', gl.LINEAR], ['WRAP_S', gl.CLAMP_TO_EDGE], ['WRAP_T', gl.CLAMP_TO_EDGE]])
    gl.texParameteri(gl.TEXTURE_2D, gl[`TEXTURE_${name}`], value);
}

// A pixel for the direction and one for the radiance under the pointer.
function makePicker() {
  const frame = gl.createFramebuffer(), targets = [gl.COLOR_ATTACHMENT0, gl.COLOR_ATTACHMENT1];
  gl.bindFramebuffer(gl.FRAMEBUFFER, frame);
  for (const target of targets) {
    const buffer = gl.createRenderbuffer();
    gl.bindRenderbuffer(gl.RENDERBUFFER, buffer);
    gl.renderbufferStorage(gl.RENDERBUFFER, gl.RGBA32UI, 1, 1);
    gl.framebufferRenderbuffer(gl.FRAMEBUFFER, target, gl.RENDERBUFFER, buffer);
  }
  gl.drawBuffers(targets);
  gl.bindFramebuffer(gl.FRAMEBUFFER, null);
  return { frame, targets, ...makeProgram('#define PICK\n') };
}

// ---- drawing ---------------------------------------------------------------------------------------------------------

function camera() {
  const yaw = state.yaw * degrees, pitch = state.pitch * degrees;
  return {
    forward: [Math.sin(yaw) * Math.cos(pitch), Math.sin(pitch), Math.cos(yaw) * Math.cos(pitch)],
    right: [-Math.cos(yaw), 0, Math.sin(yaw)],
    up: [-Math.sin(yaw) * Math.sin(pitch), Math.cos(pitch), -Math.cos(yaw) * Math.sin(pitch)],
  };
}

const lastLevel = data.textures.ggx.levels.length - 1;

function ballUniform() {
  const surfaces = { ggx: (level) => level, diffuse: () => -1, dielectric: (level) => -2 - level };
  return state.balls.flatMap(({ x, y, surface, roughness }) =>
    [x, y, state.ballsShown ? ballRadius : 0, surfaces[surface](roughness * lastLevel)]);
}

function setUniforms({ program, at }) {
  gl.useProgram(program);
  gl.uniform2f(at('size'), canvas.width, canvas.height);
  gl.uniform1i(at('view'), state.view);
  for (const [name, axis] of Object.entries(camera())) gl.uniform3fv(at(name), axis);
  gl.uniform1f(at('spread'), Math.tan(0.5 * state.fov * degrees));
  const c = Math.cos(data.forward * degrees), s = Math.sin(data.forward * degrees);
  gl.uniformMatrix3fv(at('turn'), false, [c, 0, -s, 0, 1, 0, s, 0, c]);
  textureNames.forEach((name, unit) => gl.uniform1i(at(name), unit));
  gl.uniform1i(at('dielectric'), textureNames.length);
  gl.uniform1f(at('last_level'), lastLevel);
  gl.uniform1i(at('image'), state.image);
  gl.uniform1f(at('level'), state.image === 1 ? state.blur * lastLevel : state.level);
  gl.uniform1f(at('gain'), data.scale * 2 ** state.exposure);
  gl.uniform1i(at('curve'), state.curve);
  gl.uniform4fv(at('balls'), ballUniform());
}

let painter, picker, waiting = false;

function draw() {
  gl.bindFramebuffer(gl.FRAMEBUFFER, null);
  gl.viewport(0, 0, canvas.width, canvas.height);
  setUniforms(painter);
  gl.drawArrays(gl.TRIANGLES, 0, 3);
}

// @param x, y in pixels of the canvas, y from below. @return nothing beside the map; else direction and radiance.
function pick(x, y) {
  gl.bindFramebuffer(gl.FRAMEBUFFER, picker.frame);
  gl.viewport(0, 0, 1, 1);
  setUniforms(picker);
  gl.uniform2f(picker.at('pointer'), x, y);
  gl.drawArrays(gl.TRIANGLES, 0, 3);
  const [direction, radiance] = picker.targets.map((target) => {
    const bits = new Uint32Array(4);
    gl.readBuffer(target);
    gl.readPixels(0, 0, 1, 1, gl.RGBA_INTEGER, gl.UNSIGNED_INT, bits);
    return { any: bits[3] === 1, values: [...new Float32Array(bits.buffer, 0, 3)] };
  });
  return direction.any ? { direction: direction.values, radiance: radiance.values.map((v) => v * data.scale) } : null;
}

// Once a frame, however much changes.
function redraw() {
  if (waiting) return;
  waiting = true;
  requestAnimationFrame(() => {
    waiting = false;
    draw();
    tell();
  });
}

function resize() {
  const ratio = window.devicePixelRatio || 1;
  canvas.width = Math.max(1, Math.round(canvas.clientWidth * ratio));
  canvas.height = Math.max(1, Math.round(canvas.clientHeight * ratio));
  redraw();
}

// ---- reading ---------------------------------------------------------------------------------------------------------

let pointerAt = null;  // In pixels from below; null: the middle.

function tell() {
  const found = pick(...(pointerAt ?? [canvas.width / 2, canvas.height / 2]));
  if (!found) {
    element('reading').textContent = 'nothing there';
    return;
  }
  const { direction: [x, y, z], radiance: [r, g, b] } = found;
  const luminance = 0.2126 * r + 0.7152 * g + 0.0722 * b;
  const stops = luminance > 0 ? `${Math.log2(luminance).toFixed(2)} stops` : 'black';
  element('reading').textContent =
    `radiance ${[r, g, b].map((v) => v.toPrecision(3)).join('  ')}   ${stops}\n` +
    `towards (${[x, y, z].map((v) => v.toFixed(3)).join(', ')})   azimuth ${(Math.atan2(x, z) / degrees).toFixed(1)}, ` +
    `elevation ${(Math.asin(Math.max(-1, Math.min(1, y))) / degrees).toFixed(1)}`;
}

// ---- moving ----------------------------------------------------------------------------------------------------------

const clamp = (x, low, high) => Math.max(low, Math.min(high, x));

function turnBy(yaw, pitch) {
  state.yaw = (state.yaw + yaw + 540) % 360 - 180;
  state.pitch = clamp(state.pitch + pitch, -90, 90);
  redraw();
}
function zoomBy(factor) {
  state.fov = clamp(state.fov * factor, 2, 150);
  redraw();
}
function moveBall(dx, dy) {
  const ball = state.balls[state.ball], wide = canvas.width / canvas.height;
  ball.x = clamp(ball.x + dx, -wide, wide);
  ball.y = clamp(ball.y + dy, -1, 1);
  redraw();
}

// The pointer in half heights of the canvas, from its middle, upwards.
function place(event) {
  const box = canvas.getBoundingClientRect();
  return [(2 * (event.clientX - box.left) - box.width) / box.height, 1 - 2 * (event.clientY - box.top) / box.height];
}

function ballUnder([x, y]) {
  if (!state.ballsShown || state.view !== 0) return -1;
  return state.balls.findIndex((ball) => Math.hypot(x - ball.x, y - ball.y) < ballRadius);
}

const fingers = new Map();  // Pointers that are down, by their number.
let dragged = -1;           // The ball, or -1: the view.
const span = () => {
  const [a, b] = [...fingers.values()];
  return Math.hypot(a[0] - b[0], a[1] - b[1]);
};

canvas.addEventListener('pointerdown', (event) => {
  fingers.set(event.pointerId, place(event));
  dragged = ballUnder(place(event));
  if (dragged >= 0) {
    state.ball = dragged;
    showState();
  }
  canvas.setPointerCapture(event.pointerId);
});
canvas.addEventListener('pointermove', (event) => {
  const now = place(event), before = fingers.get(event.pointerId);
  pointerAt = [(now[0] * canvas.height + canvas.width) / 2, (now[1] + 1) * canvas.height / 2];
  if (!before) return redraw();
  const apart = fingers.size === 2 ? span() : 0;
  fingers.set(event.pointerId, now);
  if (fingers.size === 2) return zoomBy(apart / Math.max(1e-3, span()));
  const dx = now[0] - before[0], dy = now[1] - before[1], scale = state.fov / 2;
  if (dragged >= 0) moveBall(dx, dy);
  else turnBy(dx * scale, -dy * scale);
});
for (const name of ['pointerup', 'pointercancel'])
  canvas.addEventListener(name, (event) => fingers.delete(event.pointerId));
canvas.addEventListener('pointerleave', () => {
  pointerAt = null;
  redraw();
});
canvas.addEventListener('wheel', (event) => {
  event.preventDefault();
  zoomBy(1.001 ** event.deltaY);
}, { passive: false });
canvas.addEventListener('keydown', (event) => {
  const arrows = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] };
  const step = arrows[event.key];
  if (step && event.shiftKey) moveBall(0.05 * step[0], 0.05 * step[1]);
  else if (step) turnBy(-5 * step[0], 5 * step[1]);
  else if (event.key === '+' || event.key === '=') zoomBy(0.9);
  else if (event.key === '-') zoomBy(1 / 0.9);
  else return;
  event.preventDefault();
});

// ---- controls --------------------------------------------------------------------------------------------------------

const images = textureNames.flatMap((name, image) => data.textures[name].levels.map((level, k) => ({ image, level: k, name: level.name })))
  .filter(({ image, level }) => image !== 1 || level === 0);

function addOptions(select, names) {
  names.forEach((name, k) => select.add(new Option(name, k)));
}

function showState() {
  const ball = state.balls[state.ball];
  element('view').value = state.view;
  element('image').value = images.findIndex(({ image, level }) => image === state.image && level === state.level);
  element('blur').value = state.blur;
  element('blur').disabled = state.image !== 1;
  element('blur-value').textContent = `roughness ${state.blur.toFixed(2)}, level ${(state.blur * lastLevel).toFixed(1)}`;
  element('exposure').value = state.exposure;
  element('stops').textContent = `${state.exposure.toFixed(2)} stops`;
  element('curve').value = curves[state.curve];
  element('balls').disabled = state.view !== 0;
  element('balls-shown').checked = state.ballsShown;
  element('ball').value = state.ball;
  element('surface').value = ball.surface;
  element('roughness').value = ball.roughness;
  element('roughness').disabled = ball.surface === 'diffuse';
  element('roughness-value').textContent = ball.roughness.toFixed(2);
}

function onInput(id, change) {
  element(id).addEventListener('input', (event) => {
    change(event.target);
    showState();
    redraw();
  });
}

function addControls() {
  addOptions(element('view'), views);
  addOptions(element('image'), images.map(({ name }) => name));
  onInput('view', ({ value }) => { state.view = Number(value); });
  onInput('image', ({ value }) => Object.assign(state, { image: images[value].image, level: images[value].level }));
  onInput('blur', ({ value }) => { state.blur = Number(value); });
  onInput('exposure', ({ value }) => { state.exposure = Number(value); });
  onInput('curve', ({ value }) => { state.curve = curves.indexOf(value); });
  onInput('balls-shown', ({ checked }) => { state.ballsShown = checked; });
  onInput('ball', ({ value }) => { state.ball = Number(value); });
  onInput('surface', ({ value }) => { state.balls[state.ball].surface = value; });
  onInput('roughness', ({ value }) => { state.balls[state.ball].roughness = Number(value); });
}

function addFacts() {
  const body = element('facts').tBodies[0];
  for (const [name, value] of data.facts) {
    const row = body.insertRow(), head = document.createElement('th');
    head.scope = 'row';
    head.textContent = name;
    row.append(head);
    row.insertCell().textContent = value;
  }
  element('honest').textContent = data.honest;
}

function start() {
  addFacts();
  if (!gl) throw new Error('this browser has no WebGL 2');
  textureNames.forEach((name, unit) => makeTexture(unit, data.textures[name]));
  makeTable(textureNames.length, data.dielectric);
  painter = makeProgram('');
  picker = makePicker();
  addControls();
  showState();
  new ResizeObserver(resize).observe(canvas);
}

try {
  start();
} catch (error) {
  element('failure').textContent = `Nothing can be drawn: ${error.message}`;
  element('failure').hidden = false;
}
