// Shadows of punctual lights: between four texels of a shadow map the outline is where they weigh the same.
layout(binding = UNIT_SHADOWS) uniform sampler2DArray shadow_maps;
uniform bool shadows;

// @param place from the viewpoint, world axes. @param normal unit, on the side of the light.
bool in_shadow(Light light, vec3 place, vec3 normal) {
  if (!shadows) return false;
  vec3 way = place - light.position.xyz, size = abs(way);
  int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
  int number = int(light.cone.z) + (light.cone.w == 6 ? 2 * axis + (way[axis] < 0 ? 1 : 0) : 0);
  ShadowView f = shadow_views[number];
  Seen s = seen_by(f, place, normal);
  if (is_parallel(f) && max(abs(s.at.x), abs(s.at.y)) > 1) return false;

  ivec2 last = textureSize(shadow_maps, 0).xy - 1;
  vec2 texel = (0.5 + 0.5 * s.at.xy) * (last + 1) - 0.5, part = fract(texel);
  float dark = 0;
  for (int k = 0; k < 4; ++k) {
    ivec2 step = ivec2(k & 1, k >> 1), there = clamp(ivec2(floor(texel)) + step, ivec2(0), last);
    vec3 centre = vec3(2 * (vec2(there) + 0.5) / (last + 1) - 1, 1);
    vec2 share = mix(1 - part, part, vec2(step));
    if (is_behind(s, f, texelFetch(shadow_maps, ivec3(there, number), 0).xyz, centre)) dark += share.x * share.y;
  }
  return dark > 0.5;
}
