// three.js: EXRLoader, an equirectangular texture as background and environment, MeshStandardMaterial.
import * as THREE from 'three';
import { EXRLoader } from 'three/addons/loaders/EXRLoader.js';
import { scene_of } from './three_scene.mjs';

// PMREMGenerator's own filter, of 256 samples, is wider than the lobe that it samples.
export const limits = { width: Infinity };

export const world = (d) => d;

export async function open(folder) {
  const probe = await new EXRLoader().loadAsync(`${folder}/background.exr`);
  probe.mapping = THREE.EquirectangularReflectionMapping;
  return scene_of(probe, probe);
}
