// Babylon.js: CubeTexture.CreateFromPrefilteredData of a DDS file, createDefaultSkybox.
import { new_scene, ready, shown } from './babylon_scene.mjs';
export { world } from './babylon_scene.mjs';

// Levels 2 to 4 of 128 texels: lod = 0.8 log2(128 roughness^2).
export const roughness = [2, 3, 4].map((k) => Math.sqrt(2 ** (k / 0.8) / 128));
// Its dielectrics do not take from diffuse light what they mirror towards the rim.
// It mixes irradiance into what is rough, and a texel of level 2 is half as wide as its lobe.
export const limits = { dielectric: Infinity, width: 0.25 };

export async function open(folder) {
  const scene = new_scene();
  scene.environmentTexture = BABYLON.CubeTexture.CreateFromPrefilteredData(`${folder}/environment.dds`, scene);
  const background = new BABYLON.CubeTexture(`${folder}/background.dds`, scene);
  await Promise.all([ready(scene.environmentTexture), ready(background)]);
  background.gammaSpace = false;
  return shown(scene, background);
}
