// three.js: UltraHDRLoader for the background, a JPEG with a gain map; KTX2Loader for the levels, as in three.mjs.
import * as THREE from 'three';
import { UltraHDRLoader } from 'three/addons/loaders/UltraHDRLoader.js';
import { limits as of_ktx2, loader } from './three.mjs';
import { scene_of } from './three_scene.mjs';

export { roughness, world } from './three.mjs';

// Beside the balls is the sky. UltraHDRLoader multiplies before the sRGB curve, so that a white of 1 is 1% brighter.
export const limits = { ...of_ktx2, metal: 0.01, dielectric: 0.01 };

export async function open(folder) {
  const [sky, light] = await Promise.all([
    new UltraHDRLoader().loadAsync(`${folder}/background.jpg`), loader.loadAsync(`${folder}/environment.ktx2`)]);
  sky.mapping = THREE.EquirectangularReflectionMapping;
  light.isPMREMTexture = true;
  return scene_of(sky, light);
}
