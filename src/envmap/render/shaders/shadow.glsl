// Shadows of punctual lights. A texel of a shadow map holds the plane that its light sees there first, so that nothing is
// compared but what is known exactly, and there is no bias but what floats are rounded by: a surface is in shadow where the
// plane lies before it at its own place, and before the surface's plane at the texel's centre. The first spares what is
// concave, the second what is convex (Dou, Yan, Kerzner, Dai and Wyman 2014, "Adaptive depth bias for shadow maps").
// Between four texels the outline is where they weigh the same.
layout(binding = UNIT_SHADOWS) uniform sampler2DArray shadow_maps;
uniform bool shadows;

// @param place from the viewpoint, world axes. @param normal unit, on the side of the light.
bool in_shadow(Light light, vec3 place, vec3 normal) {
  if (!shadows) return false;
  vec3 way = place - light.position.xyz, size = abs(way);
  int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
  int number = int(light.cone.z) + (light.cone.w == 6 ? 2 * axis + (way[axis] < 0 ? 1 : 0) : 0);
  LightFace f = light_faces[number];
  vec3 p = to_light(f, place - vec3(f.right.w, f.up.w, f.ahead.w)), n = to_light(f, normal);
  float depth = is_parallel(f) ? 1 : p.z, nearness = is_parallel(f) ? -p.z : 1 / p.z;
  vec3 at = vec3(p.xy / (f.lens.x * depth), 1), own = plane_seen(f, n, dot(n, p));
  if (is_parallel(f) && max(abs(at.x), abs(at.y)) > 1) return false;

  float rounding = (length(place) + length(p)) / 131072, own_slope = slope(f, own), dark = 0;
  ivec2 last = textureSize(shadow_maps, 0).xy - 1;
  vec2 texel = (0.5 + 0.5 * at.xy) * (last + 1) - 0.5, part = fract(texel);
  for (int k = 0; k < 4; ++k) {
    ivec2 step = ivec2(k & 1, k >> 1), there = clamp(ivec2(floor(texel)) + step, ivec2(0), last);
    vec3 middle = vec3(2 * (vec2(there) + 0.5) / (last + 1) - 1, 1);
    vec3 plane = texelFetch(shadow_maps, ivec3(there, number), 0).xyz;
    float seen = dot(plane, middle), seen_depth = is_parallel(f) ? 1 : 1 / seen;
    bool before = depth * (dot(plane, at) - nearness) > rounding * slope(f, plane) &&
                  seen_depth * (seen - dot(own, middle)) > rounding * own_slope;
    vec2 share = mix(1 - part, part, vec2(step));
    if (before) dark += share.x * share.y;
  }
  return dark > 0.5;
}
