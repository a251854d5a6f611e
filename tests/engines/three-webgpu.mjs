// three.js: what three.mjs loads, drawn by WebGPURenderer.
import { limits as of_webgl } from './three.mjs';
import { renderer } from './three_scene.mjs';

export { open, roughness, world } from './three.mjs';

// WebGPU is SwiftShader's, in which WebGLRenderer's highlights are as wide.
export const limits = { ...of_webgl, width: 0.4 };

if (!renderer.backend?.isWebGPUBackend) throw new Error('WebGPU does not start here');
