// Babylon.js: CubeTexture.CreateFromPrefilteredData, createDefaultSkybox, PBRMaterial, drawn into floats.
// Its world is left-handed, and imported glTF files lie in it with X negated.
export const world = (d) => [-d[0], d[1], d[2]];
// Levels 2 to 4 of 128 texels: lod = 0.8 log2(128 roughness^2).
export const roughness = [2, 3, 4].map((k) => Math.sqrt(2 ** (k / 0.8) / 128));
// Its dielectrics do not take from diffuse light what they mirror towards the rim.
// It mixes irradiance into what is rough, and a texel of level 2 is half as wide as its lobe.
export const limits = { dielectric: Infinity, width: 0.25 };

await new Promise((loaded, failed) => {
  const script = document.createElement('script');
  Object.assign(script, { src: 'node_modules/babylonjs/babylon.js', onload: loaded, onerror: failed });
  document.head.append(script);
});

const engine = new BABYLON.Engine(document.getElementById('canvas'), false);
const ready = (texture) => new Promise((loaded) => BABYLON.BaseTexture.WhenAllReady([texture], loaded));

export async function open(folder) {
  const scene = new BABYLON.Scene(engine);
  scene.environmentTexture = BABYLON.CubeTexture.CreateFromPrefilteredData(`${folder}/environment.dds`, scene);
  const background = new BABYLON.CubeTexture(`${folder}/background.dds`, scene);
  await Promise.all([ready(scene.environmentTexture), ready(background)]);
  background.gammaSpace = false;
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
