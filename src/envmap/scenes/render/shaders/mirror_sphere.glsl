// A mirror's map as a sphere map.
layout(binding = UNIT_MIRROR) uniform sampler2DArray mirror;
// @param at as GL has it: surfaces.glsl.
vec4 shown_at(vec3 at, vec2 on_face, float level);

vec3 place_of(vec3 d) { return sphere_located(d); }
int face_of(vec3 place) { return 0; }
vec3 in_face(vec3 place, float face) { return vec3(place.xy, face); }

// Beyond the rim there is nothing; a filter must not read it.
vec3 within_rim(vec3 at, float level) {
  vec2 off = 2 * at.xy - 1;
  float most = 1 - 3 * exp2(level) / textureSize(mirror, 0).x, r = length(off);
  return vec3(0.5 + 0.5 * off * min(1, most / max(r, 1e-6)), 0);
}
vec4 mirror_at_place(vec3 at, float level) {
  at = within_rim(at, level);
  return shown_at(at, at.xy, level);
}

float nearness_at(vec3 d) { return textureLod(mirror, within_rim(place_of(d), 0), 0).a; }

vec4 mirror_at(vec3 d, float level) { return mirror_at_place(place_of(d), level); }
