// A mirror's map as a sphere map.
layout(binding = UNIT_MIRROR) uniform sampler2DArray mirror;

vec3 place_of(vec3 d) { return sphere_located(d); }
vec3 in_face(vec3 place, float face) { return vec3(place.xy, face); }

// Beyond the rim there is nothing; a filter must not read it.
vec4 texel_at(vec3 at, float level) {
  vec2 off = 2 * at.xy - 1;
  float most = 1 - 3 * exp2(level) / textureSize(mirror, 0).x, r = length(off);
  return textureLod(mirror, vec3(0.5 + 0.5 * off * min(1, most / max(r, 1e-6)), 0), level);
}
vec3 mirror_at_place(vec3 at, float level) { return tint(0) * texel_at(at, level).rgb; }

float nearness_at(vec3 d) { return texel_at(place_of(d), 0).a; }

vec3 mirror_at(vec3 d, float level) { return mirror_at_place(place_of(d), level); }
