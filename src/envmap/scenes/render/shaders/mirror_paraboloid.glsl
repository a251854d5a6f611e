// A mirror's map on two paraboloids.
layout(binding = UNIT_MIRROR) uniform sampler2DArray mirror;
// @param at as GL has it: surfaces.glsl.
vec4 shown_at(vec3 at, vec2 on_face, float level);

vec3 place_of(vec3 d) { return paraboloid_located(d); }
vec3 in_face(vec3 place, float face) { return vec3(place.xy, face); }

int face_of(vec3 place) { return int(place.z); }

vec4 mirror_at_place(vec3 at, float level) { return shown_at(at, at.xy, level); }

float nearness_at(vec3 d) { return textureLod(mirror, place_of(d), 0).a; }

// Both halves go on beyond their rim: within a texel of it they are mixed, and there is no seam even where the square's
// sides touch the disc.
vec4 mirror_at(vec3 d, float level) {
  float texel = 2 * exp2(level) / textureSize(mirror, 0).x, front = clamp(0.5 + 0.5 * d.z / texel, 0, 1);
  if (front <= 0) return mirror_at_place(paraboloid_half(d, 1), level);
  if (front >= 1) return mirror_at_place(paraboloid_half(d, 0), level);
  return mix(mirror_at_place(paraboloid_half(d, 1), level), mirror_at_place(paraboloid_half(d, 0), level), front);
}
