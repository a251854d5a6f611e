// three.js: KTX2Loader, cubes of UASTC HDR transcoded to what the card takes; levels that are taken as they are.
import { KTX2Loader } from 'three/addons/loaders/KTX2Loader.js';
import { renderer, scene_of } from './three_scene.mjs';

// Diffuse light is a level of faces of 8 texels, so that a block of 4x4 spans 45 degrees of a probe that has all hues.
// Between texels as coarse as these levels' a highlight is wider.
export const limits = { diffuse: 0.06, width: 0.2 };

// Of levels 2 to 4 of six: the first is finer than the faces' texels, and the last is the whole hemisphere.
export const roughness = [2, 3, 4].map((k) => 1 - Math.sqrt(1 - k / 5));

export const world = (d) => d;

export const loader = new KTX2Loader().setTranscoderPath('./node_modules/three/examples/jsm/libs/basis/').detectSupport(renderer);

export async function open(folder) {
  const [sky, light] = await Promise.all(['background', 'environment'].map((name) => loader.loadAsync(`${folder}/${name}.ktx2`)));
  light.isPMREMTexture = true;
  return scene_of(sky, light);
}
