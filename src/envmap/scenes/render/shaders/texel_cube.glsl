// Texels of a mirror's map on a cube.
// @param at from -1 to 1. @param texel its side there. @return solid angle, over any constant.
float solid_angle(vec2 at, float texel) { return pow(1 + dot(at, at), -1.5); }

// Radians that a texel's side takes, for a face from -1 to 1 of which it is `texel`: the root of its solid angle.
float texel_angle(vec3 d, float texel) { return texel * pow(max(abs(d.x), max(abs(d.y), abs(d.z))), 1.5); }
