// Texels of a mirror's sphere map, all of one solid angle: see texel_cube.glsl. Those that the rim cuts count for what lies
// inside it, roughly.
float solid_angle(vec2 at, float texel) {
  if (length(max(abs(at) - 0.5 * texel, 0)) >= 1) return 0;
  return clamp(0.5 + (1 - length(at)) / texel, 0.01, 1.0);
}

float texel_angle(vec3 d, float texel) { return 2 * texel; }
