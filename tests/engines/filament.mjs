// Filament: createIblFromKtx1, createSkyFromKtx1, and a ball as a glTF file in gltfio's own material. What it draws is bytes,
// linear without post-processing: rounded by 1/510 of 1 / exposure.
import * as matrices from './node_modules/gl-matrix/esm/index.js';
import { ball_glb } from './ball.mjs';

export const world = (d) => d;
// Levels 2 to 4 of 5.
export const roughness = [1 - Math.sqrt(1 / 2), 0.5, 1];

Object.assign(window, matrices);
await new Promise((loaded, failed) => {
  const script = document.createElement('script');
  Object.assign(script, { src: 'node_modules/filament/filament.js', onload: loaded, onerror: failed });
  document.head.append(script);
});
await new Promise((ready) => Filament.init([], ready));

const canvas = document.getElementById('canvas');
const engine = Filament.Engine.create(canvas, { preserveDrawingBuffer: true });
const swap_chain = engine.createSwapChain(), renderer = engine.createRenderer(), view = engine.createView();
const camera = engine.createCamera(Filament.EntityManager.get().create()), loader = engine.createAssetLoader();
view.setCamera(camera);
view.setPostProcessingEnabled(false);
const gl = canvas.getContext('webgl2');

const bytes = async (url) => new Uint8Array(await (await fetch(url)).arrayBuffer());
const frame = () => new Promise((drawn) => requestAnimationFrame(drawn));

export async function open(folder) {
  const scene = engine.createScene(), read = engine.createIblFromKtx1(await bytes(`${folder}/ibl.ktx`));
  // It reads the harmonics, but does not hand them on.
  const light = Filament.IndirectLight.Builder().reflections(read.getReflectionsTexture()).irradianceSh(3, read.shfloats).build(engine);
  scene.setIndirectLight(light);
  scene.setSkybox(engine.createSkyFromKtx1(await bytes(`${folder}/sky.ktx`)));
  view.setScene(scene);
  const balls = {};
  let shown = null;
  return {
    async render({ eye, target, up, fov, size, ball, exposure = 1 }) {
      if (shown) scene.removeEntities(shown.getEntities());
      shown = null;
      if (ball) {
        const name = JSON.stringify(ball);
        if (!balls[name]) {
          balls[name] = loader.createAsset(ball_glb(ball));
          await new Promise((done) => balls[name].loadResources(done, () => {}, '', 0));
        }
        shown = balls[name];
        scene.addEntities(shown.getEntities());
      }
      camera.setProjectionFov(fov, 1, 0.1, 100, Filament.Camera$Fov.VERTICAL);
      camera.lookAt(eye, target, up);
      camera.setExposureDirect(1);
      light.setIntensity(exposure);
      view.setViewport([0, 0, size, size]);
      for (let k = 0; k < 2; ++k) {  // It may leave out the first frame after a change.
        await frame();
        renderer.render(swap_chain, view);
        engine.execute();
      }
      const pixels = new Uint8Array(4 * size * size);
      gl.bindFramebuffer(gl.FRAMEBUFFER, null);
      gl.readPixels(0, 0, size, size, gl.RGBA, gl.UNSIGNED_BYTE, pixels);
      return Float32Array.from(pixels, (v) => v / 255 / exposure);
    },
  };
}
