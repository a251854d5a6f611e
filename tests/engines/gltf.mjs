// EXT_lights_image_based as Babylon.js' glTF loader has it.
import { new_scene, ready, shown } from './babylon_scene.mjs';
export { world } from './babylon_scene.mjs';

// Level 4 + log2(roughness) is what its shader looks at, not the extension's 4 x roughness: highlights are wider.
export const limits = { dielectric: Infinity, width: Infinity };

export async function open(folder) {
  const scene = new_scene();
  await BABYLON.SceneLoader.AppendAsync(`${folder}/`, 'light.glb', scene);
  await ready(scene.environmentTexture);
  scene.environmentTexture.gammaSpace = false;  // The loader leaves it true: linear levels would be decoded once more.
  return shown(scene, scene.environmentTexture);
}
