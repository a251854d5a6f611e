// What is asked of every engine. An engine's module has
//   world(d)      where a direction of the probe stands in the engine's world;
//   roughness     of its levels, where it takes them as they are: between levels it mixes two lobes, which is no lobe of GGX;
//   sky           false where the folder has none to show;
//   limits        what it is held to, where that is not `common` below, each with the reason beside it;
//   open(folder)  -> { render(shot) }: loads a baked folder. A shot is
//     { eye, target, up, fov (degrees), size (pixels), ball: null or { metallic, roughness } of radius 1 at the origin,
//       exposure: what engines that draw bytes multiply by first, and divide by after },
//   and comes back as floats, linear, r g b a, `size` squared. The ball is white.

const common = { sky: 0.02, mirror: 0.03, diffuse: 0.03, metal: 0.005, dielectric: 0.005, width: 0.05 };

const scaled = (v, k) => v.map((x) => x * k);
const unit = (v) => scaled(v, 1 / Math.hypot(...v));
const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const upright = (d) => (Math.abs(d[1]) > 0.9 ? [0, 0, 1] : [0, 1, 0]);

const axes = [[1, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0], [0, 0, 1], [0, 0, -1]];
// Beside the corners of a cube: at the corner of a box that is the sky a pixel may belong to none of its faces.
const corners = [-1, 1].flatMap((x) => [-1, 1].flatMap((y) => [-1, 1].map((z) => unit([x, 0.97 * y, 1.02 * z]))));
// Off the axes: faces' middles are where turns of the map about an axis would not show.
const oblique = [[3, 2, 1], [-1, 3, 2], [2, -1, -3], [-2, -3, 1]].map(unit);
const all = [...axes, ...corners, ...oblique];

// What is at the middle of an image of an odd size.
const middle = (pixels) => Array.from(pixels.slice(2 * (pixels.length / 4 - 1), 2 * (pixels.length / 4 - 1) + 3));
const off = (a, b) => Math.max(...a.map((x, c) => Math.abs(x - b[c])));

const view = { fov: 10, size: 21 };
const look = async (scene, d) =>
  middle(await scene.render({ eye: [0, 0, 0], target: d, up: upright(d), ball: null, ...view }));
// The middle of the ball as seen from d: it faces d, and mirrors d.
const facing = async (scene, d, ball, exposure = 1) =>
  middle(await scene.render({ eye: scaled(d, 10), target: [0, 0, 0], up: upright(d), ball, exposure, ...view }));

// Largest differences from what the map shows, 0.5 + 0.5 d: in the sky, in a mirror, and on a white diffuse ball, which shows
// 0.5 + d / 3 by Lambert's law.
async function directions(engine, folder) {
  const start = performance.now(), scene = await engine.open(folder);
  const first_look = engine.world([0, 0, 1]);
  await (engine.sky === false ? facing(scene, first_look, { metallic: 1, roughness: 0 }) : look(scene, first_look));
  const first_picture_ms = performance.now() - start;
  const shown = { mirror: 0, diffuse: 0 };
  for (const d of all) {
    const w = engine.world(d), colour = d.map((x) => 0.5 + 0.5 * x), lit = d.map((x) => 0.5 + x / 3);
    if (engine.sky !== false) shown.sky = Math.max(shown.sky ?? 0, off(await look(scene, w), colour));
    shown.mirror = Math.max(shown.mirror, off(await facing(scene, w, { metallic: 1, roughness: 0 }), colour));
    shown.diffuse = Math.max(shown.diffuse, off(await facing(scene, w, { metallic: 0, roughness: 1 }), lit));
  }
  return { shown, first_picture_ms };
}

// White everywhere: how far balls stand out, relative to white, anywhere on them. Without a sky the ball fills the picture.
async function furnace(engine, folder) {
  const fov = engine.sky === false ? 8 : 11;
  const scene = await engine.open(folder), found = {};
  for (const metallic of [1, 0])
    for (const roughness of [0, 0.25, 0.5, 0.75, 1]) {
      const pixels = await scene.render({
        eye: [0, 0, 10], target: [0, 0, 0], up: [0, 1, 0], fov, size: 96, ball: { metallic, roughness }, exposure: 0.8 });
      let most = 0;
      for (let k = 0; k < pixels.length; ++k) if (k % 4 < 3) most = Math.max(most, Math.abs(pixels[k] - 1));
      found[`${metallic ? 'metal' : 'dielectric'} ${roughness}`] = most;
    }
  return found;
}

// Half the width of GGX's split-sum lobe at half its height, in degrees: (1 - x) / (A + B x)^2 = 1 / (2 A^2), x = 1 - cos.
function half_width(roughness) {
  const a = roughness ** 4 * 2, b = 1 - roughness ** 4, value = (x) => (1 - x) / (a + b * x) ** 2;
  let low = 0, high = 1;
  for (let k = 0; k < 60; ++k) {
    const x = (low + high) / 2;
    if (value(x) > value(0) / 2) low = x;
    else high = x;
  }
  return (Math.acos(1 - low) * 180) / Math.PI;
}

// A small sun in a metal ball that faces away from it by more and more: where it is half as bright as at its brightest.
async function sun(engine, folder) {
  const scene = await engine.open(folder), towards = unit([1, 2, 3]), aside = unit(cross(towards, [0, 1, 0]));
  const found = {};
  for (const roughness of engine.roughness ?? [0.3, 0.4, 0.5, 0.6, 0.75]) {
    const wanted = half_width(roughness), ball = { metallic: 1, roughness };
    let exposure = 1;
    const at = async (degrees) => {
      const t = (degrees * Math.PI) / 180;
      return (await facing(scene, engine.world(unit(towards.map((x, k) => x * Math.cos(t) + aside[k] * Math.sin(t)))), ball, exposure))[0];
    };
    let top = await at(0);
    for (let k = 0; k < 8 && (top * exposure > 0.95 || top * exposure < 0.4); ++k) {
      exposure *= top * exposure > 0.95 ? 0.4 : 1.9;
      top = await at(0);
    }
    let before = 0, height = top, degrees = 0;
    while (height > top / 2 && degrees < 90) {
      before = height;
      degrees += wanted / 12;
      height = await at(degrees);
    }
    const half = degrees - ((top / 2 - height) / (before - height)) * (wanted / 12);
    found[rounded(roughness)] = { degrees: half, wanted };
  }
  return found;
}

const rounded = (x) => Number(x.toPrecision(3));
const round_all = (o) => Object.fromEntries(
  Object.entries(o).map(([k, v]) => [k, typeof v === 'number' ? rounded(v) : round_all(v)]));

export async function measure(engine, name) {
  const limits = { ...common, ...engine.limits }, failures = [];
  const { shown, first_picture_ms } = await directions(engine, `probes/${name}-directions`);
  for (const [what, most] of Object.entries(shown))
    if (!(most <= limits[what])) failures.push(`directions: ${what} is off by ${rounded(most)}`);
  const white = await furnace(engine, `probes/${name}-white`);
  for (const [what, most] of Object.entries(white))
    if (!(most <= limits[what.split(' ')[0]])) failures.push(`furnace: ${what} stands out by ${rounded(most)}`);
  const widths = await sun(engine, `probes/${name}-sun`);
  for (const [roughness, { degrees, wanted }] of Object.entries(widths))
    if (!(Math.abs(degrees / wanted - 1) <= limits.width))
      failures.push(`sun: at roughness ${roughness} half as bright at ${rounded(degrees)} degrees, not at ${rounded(wanted)}`);
  return { failures, first_picture_ms: Math.round(first_picture_ms), directions: round_all(shown), furnace: round_all(white), sun: round_all(widths) };
}
