// What surfaces keep of the environment's diffuse light from each other: its distant lights (light/distant_lights.h), each
// with a shadow map.
layout(binding = UNIT_DISTANT_SHADOWS) uniform sampler2DArray distant_shadows;
layout(std140, binding = BLOCK_DISTANT_FACES) uniform DistantFaces { ShadowView distant_faces[MOST_DISTANT_LIGHTS]; };
layout(std140, binding = BLOCK_DISTANT_LIGHTS) uniform DistantLights { vec4 distant_lights[MOST_DISTANT_LIGHTS]; };
uniform int distant_count;

// Whether something keeps a light from a place. The texel of the place says so, unless it sees past the place's own surface: just
// inside the outline of a closed room it may see what lies outside, and light would leak in along the edges of walls. Then the
// texels on the other sides of the place are asked: one of the four round it has its centre inside such an outline, too.
bool is_kept_off(int number, ShadowView f, Seen s) {
  ivec2 last = textureSize(distant_shadows, 0).xy - 1;
  vec2 at = (0.5 + 0.5 * s.at.xy) * (last + 1);
  ivec2 own = ivec2(floor(at)), other = own + ivec2(mix(vec2(-1), vec2(1), greaterThanEqual(fract(at), vec2(0.5))));
  for (int k = 0; k < 4; ++k) {
    ivec2 texel = clamp(ivec2((k & 1) == 0 ? own.x : other.x, (k & 2) == 0 ? own.y : other.y), ivec2(0), last);
    vec3 centre = vec3(2 * (vec2(texel) + 0.5) / (last + 1) - 1, 1), plane = texelFetch(distant_shadows, ivec3(texel, number), 0).xyz;
    if (is_behind(s, f, plane, centre)) return true;
    if (k == 0 && dot(plane - s.plane, centre) >= -s.rounding * s.slope) return false;
  }
  return false;
}

// The part that reaches a place.
vec3 unoccluded(vec3 place, vec3 normal) {
  vec3 all = vec3(0), reached = vec3(0);
  for (int k = 0; k < distant_count; ++k) {
    ShadowView f = distant_faces[k];
    float cosine = -dot(normal, f.ahead.xyz);
    if (cosine <= 0) continue;
    vec3 there = cosine * distant_lights[k].rgb;
    all += there;
    if (!is_kept_off(k, f, seen_by(f, place, normal))) reached += there;
  }
  return mix(vec3(1), reached / all, greaterThan(all, vec3(0)));
}
