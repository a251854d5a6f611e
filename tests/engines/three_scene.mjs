// three.js: a ball in a scene, drawn into floats by WebGLRenderer or, where the page has that build of three.js, WebGPURenderer.
import * as THREE from 'three';

const canvas = document.getElementById('canvas');
export const renderer = THREE.WebGPURenderer ? new THREE.WebGPURenderer({ canvas }) : new THREE.WebGLRenderer({ canvas });
await renderer.init?.();
const Target = THREE.WebGLRenderTarget ?? THREE.RenderTarget;

// Rows from the bottom. Those of WebGPU's buffers are from the top, and begin at multiples of 256 bytes where the buffer is not packed.
async function pixels_of(image, size) {
  const pixels = new Float32Array(4 * size * size);
  if (!THREE.WebGPURenderer) return renderer.readRenderTargetPixelsAsync(image, 0, 0, size, size, pixels);
  const read = await renderer.readRenderTargetPixelsAsync(image, 0, 0, size, size);
  const stride = read.length === pixels.length ? 4 * size : 64 * Math.ceil(size / 16);
  for (let j = 0; j < size; ++j) pixels.set(read.subarray(j * stride, j * stride + 4 * size), 4 * (size - 1 - j) * size);
  return pixels;
}
const geometry = new THREE.SphereGeometry(1, 256, 128);

export function scene_of(background, environment) {
  const scene = new THREE.Scene();
  scene.background = background;
  scene.environment = environment;
  const material = new THREE.MeshStandardMaterial({ color: 0xffffff }), mesh = new THREE.Mesh(geometry, material);
  scene.add(mesh);
  return {
    async render({ eye, target, up, fov, size, ball }) {
      mesh.visible = ball !== null;
      material.metalness = ball?.metallic ?? 0;
      material.roughness = ball?.roughness ?? 0;
      const camera = new THREE.PerspectiveCamera(fov, 1, 0.1, 100);
      camera.position.set(...eye);
      camera.up.set(...up);
      camera.lookAt(...target);
      const image = new Target(size, size, { type: THREE.FloatType });  // Linear, not tone mapped.
      renderer.setRenderTarget(image);
      renderer.render(scene, camera);
      const pixels = await pixels_of(image, size);
      image.dispose();
      return pixels;
    },
  };
}
