// Babylon.js: a white ball of its PBRMaterial under an environment, drawn into floats.
// Its world is left-handed, and imported glTF files lie in it with X negated.
export const world = (d) => [-d[0], d[1], d[2]];

const load = (src) => new Promise((loaded, failed) => {
  const script = document.createElement('script');
  Object.assign(script, { src, onload: loaded, onerror: failed });
  document.head.append(script);
});
await load('node_modules/babylonjs/babylon.js');
await load('node_modules/babylonjs-loaders/babylonjs.loaders.min.js');

const engine = new BABYLON.Engine(document.getElementById('canvas'), false);
export const ready = (texture) => new Promise((loaded) => BABYLON.BaseTexture.WhenAllReady([texture], loaded));
export const new_scene = () => new BABYLON.Scene(engine);

// @param background a cube for the sky. Without anisotropy, Babylon.js' default: at the edges of a cube's faces Mesa's llvmpipe then
// takes samples from far off. Beside a corner the sky was off by 0.093 so, by 0.0005 without, and by 0.0003 in SwiftShader with it.
export async function shown(scene, background) {
  background.anisotropicFilteringLevel = 1;
  const sky = scene.createDefaultSkybox(background, true, 1000, 0, false);  // Else the sky lights the scene, too.
  const sphere = BABYLON.MeshBuilder.CreateSphere('ball', { diameter: 2, segments: 128 }, scene);
  const material = new BABYLON.PBRMaterial('white', scene);
  material.albedoColor = BABYLON.Color3.White();
  sphere.material = material;
  const camera = new BABYLON.FreeCamera('camera', BABYLON.Vector3.Zero(), scene);
  camera.minZ = 0.1;
  camera.maxZ = 10000;
  scene.imageProcessingConfiguration.applyByPostProcess = true;  // Linear: what is drawn here is not looked at.
  await scene.whenReadyAsync();
  return {
    async render({ eye, target, up, fov, size, ball }) {
      sphere.setEnabled(ball !== null);
      material.metallic = ball?.metallic ?? 0;
      material.roughness = ball?.roughness ?? 0;
      camera.position = BABYLON.Vector3.FromArray(eye);
      camera.upVector = BABYLON.Vector3.FromArray(up);
      camera.setTarget(BABYLON.Vector3.FromArray(target));
      camera.fov = (fov * Math.PI) / 180;
      const image = new BABYLON.RenderTargetTexture('image', size, scene, {
        type: BABYLON.Constants.TEXTURETYPE_FLOAT, generateMipMaps: false, samplingMode: BABYLON.Texture.NEAREST_SAMPLINGMODE });
      image.renderList = [sky, sphere];
      image.activeCamera = camera;
      scene.activeCamera = camera;
      while (!sphere.isReady(true) || !sky.isReady(true)) await new Promise((next) => setTimeout(next, 10));
      scene.incrementRenderId();
      scene.updateTransformMatrix(true);
      image.render(false);
      const pixels = await image.readPixels();
      image.dispose();
      return pixels;
    },
  };
}
