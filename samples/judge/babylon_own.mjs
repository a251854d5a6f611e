// Babylon.js: HDRCubeTexture, filtered by its own HDRFiltering when it is loaded.
import { new_scene, ready, shown } from './babylon_scene.mjs';
export { world } from './babylon_scene.mjs';

export async function open(folder) {
  const scene = new_scene(), load = () => new BABYLON.HDRCubeTexture(`${folder}/background.hdr`, scene, 128, false, true, false, true);
  scene.environmentTexture = load();
  const background = load();
  await Promise.all([ready(scene.environmentTexture), ready(background)]);
  return shown(scene, background);
}
