// Babylon.js: HDRCubeTexture, filtered by its own HDRFiltering when it is loaded.
import { new_scene, ready, shown } from './babylon_scene.mjs';
export { world } from './babylon_scene.mjs';

export async function open(folder) {
  const scene = new_scene(), file = `${folder}/background.hdr`;
  scene.environmentTexture = new BABYLON.HDRCubeTexture(file, scene, 64, false, true, false, true);
  const background = new BABYLON.HDRCubeTexture(file, scene, 16);  // The sky, which is not looked at.
  await Promise.all([ready(scene.environmentTexture), ready(background)]);
  return shown(scene, background);
}
