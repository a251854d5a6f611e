// CesiumJS: a ball as a glTF model that stands on the equator, lit by the folder's levels and harmonics.
import { ball_glb } from './ball.mjs';

// East, north and up of the place: imported glTF files have other axes, which does not show on a ball.
export const world = (d) => [d[0], -d[2], d[1]];
// Levels 2 to 4 of 5. Level 1, roughness 0.25, is finer than its texels are for a sun so small.
export const roughness = [0.5, 0.75, 1];
// Light between the microfacets of rough metal comes from the harmonics: FmsEms in ImageBasedLightingStageFS.glsl.
export const limits = { width: 0.15 };
// The sky is six images, and is no part of the folder.
export const sky = false;

window.CESIUM_BASE_URL = './node_modules/cesium/Build/Cesium/';
await new Promise((loaded, failed) => {
  const script = document.createElement('script');
  Object.assign(script, { src: `${window.CESIUM_BASE_URL}Cesium.js`, onload: loaded, onerror: failed });
  document.head.append(script);
});

const canvas = document.getElementById('canvas');
const frame = () => new Promise((drawn) => requestAnimationFrame(drawn));
const place = Cesium.Transforms.eastNorthUpToFixedFrame(Cesium.Cartesian3.fromDegrees(0, 0, 1000));
const vector = (v) => Cesium.Cartesian3.fromArray(v);
const there = (v) => Cesium.Matrix4.multiplyByPointAsVector(place, vector(v), new Cesium.Cartesian3());

// What the scene holds before it is tone mapped.
function linear_pixels(size) {
  const gl = scene.context._gl, bound = gl.getParameter(gl.FRAMEBUFFER_BINDING), pixels = new Float32Array(4 * size * size);
  gl.bindFramebuffer(gl.FRAMEBUFFER, scene.view.sceneFramebuffer.framebuffer._framebuffer);
  gl.readPixels(0, 0, size, size, gl.RGBA, gl.FLOAT, pixels);
  gl.bindFramebuffer(gl.FRAMEBUFFER, bound);
  return pixels;
}

const scene = new Cesium.Scene({ canvas, contextOptions: { webgl: { alpha: true } } });
Object.assign(scene, { highDynamicRange: true, msaaSamples: 1, backgroundColor: Cesium.Color.BLACK });
scene.postProcessStages.fxaa.enabled = false;
for (const what of ['skyBox', 'sun', 'moon', 'skyAtmosphere']) if (scene[what]) scene[what].show = false;
scene.fog.enabled = false;
// No light, but from somewhere: a mirror that shows it is infinitely bright times 0. No direction that is looked at does.
scene.light = new Cesium.DirectionalLight({ direction: new Cesium.Cartesian3(0.36, 0.48, 0.8), intensity: 0 });
async function draw() {
  scene.initializeFrame();
  scene.render();
  await frame();
}

export async function open(folder) {
  scene.primitives.removeAll();
  const rows = (await (await fetch(`${folder}/irradiance.txt`)).text()).trim().split('\n');
  const models = {};
  const model_of = async (ball) => {
    const name = JSON.stringify(ball);
    if (models[name]) return models[name];
    const model = await Cesium.Model.fromGltfAsync({
      url: URL.createObjectURL(new Blob([ball_glb(ball)])),  // Models are cached by their address.
      modelMatrix: place,
      environmentMapOptions: { enabled: false },
      imageBasedLighting: new Cesium.ImageBasedLighting({
        specularEnvironmentMaps: `${folder}/specular.ktx2`,
        sphericalHarmonicCoefficients: rows.map((row) => vector(row.split(' ').map(Number))),
      }),
    });
    scene.primitives.add(model);
    models[name] = model;
    while (!(model.ready && model.imageBasedLighting.specularEnvironmentCubeMap?.ready)) await draw();
    await draw();
    return model;
  };
  return {
    async render({ eye, target, up, fov, size, ball }) {
      Object.assign(canvas, { width: size, height: size });
      const shown = ball && (await model_of(ball));
      for (const model of Object.values(models)) model.show = model === shown;
      const at = Cesium.Matrix4.multiplyByPoint(place, vector(eye), new Cesium.Cartesian3());
      // Camera.setView() wants unit vectors at right angles.
      const direction = Cesium.Cartesian3.normalize(there(target.map((x, k) => x - eye[k])), new Cesium.Cartesian3());
      const right = Cesium.Cartesian3.cross(direction, there(up), new Cesium.Cartesian3());
      const upwards = Cesium.Cartesian3.cross(Cesium.Cartesian3.normalize(right, right), direction, new Cesium.Cartesian3());
      scene.camera.frustum = new Cesium.PerspectiveFrustum({ fov: (fov * Math.PI) / 180, aspectRatio: 1, near: 0.1, far: 100 });
      scene.camera.setView({ destination: at, orientation: { direction, up: upwards } });
      for (let k = 0; k < 2; ++k) await draw();  // The first frame after a change may show what was before.
      return linear_pixels(size);
    },
  };
}
