// Texels of a mirror's map on two paraboloids: see texel_cube.glsl.
float solid_angle(vec2 at, float texel) { return pow(1 + dot(at, at), -2); }

float texel_angle(vec3 d, float texel) { return texel * (1 + abs(d.z)); }
