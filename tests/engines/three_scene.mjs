// three.js: a ball in a scene, drawn by WebGLRenderer into floats.
import * as THREE from 'three';

export const renderer = new THREE.WebGLRenderer({ canvas: document.getElementById('canvas') });
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
      const image = new THREE.WebGLRenderTarget(size, size, { type: THREE.FloatType });  // Linear, not tone mapped.
      renderer.setRenderTarget(image);
      renderer.render(scene, camera);
      const pixels = new Float32Array(4 * size * size);
      renderer.readRenderTargetPixels(image, 0, 0, size, size, pixels);
      image.dispose();
      return pixels;
    },
  };
}
