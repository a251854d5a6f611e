// Babylon.js: CubeTexture.CreateFromPrefilteredData of an .env file, which holds the irradiance, too.
import { new_scene, ready, shown } from './babylon_scene.mjs';
export { limits } from './babylon.mjs';
export { world } from './babylon_scene.mjs';

// Levels 3 to 5 of 256 texels: lod = 0.8 log2(256 roughness^2).
export const roughness = [3, 4, 5].map((k) => Math.sqrt(2 ** (k / 0.8) / 256));

export async function open(folder) {
  const scene = new_scene();
  scene.environmentTexture = BABYLON.CubeTexture.CreateFromPrefilteredData(`${folder}/environment.env`, scene);
  await ready(scene.environmentTexture);
  scene.environmentTexture.irradianceTexture.anisotropicFilteringLevel = 1;  // As the sky's, in babylon_scene.mjs.
  return shown(scene, scene.environmentTexture);
}
