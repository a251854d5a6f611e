// What surfaces keep of the environment's diffuse light from each other: its distant lights (render/distant_lights.h), each
// with a shadow map.
layout(binding = UNIT_DISTANT_SHADOWS) uniform sampler2DArray distant_shadows;
layout(std140, binding = BLOCK_DISTANT_FACES) uniform DistantFaces { LightFace distant_faces[MOST_DISTANT_LIGHTS]; };
layout(std140, binding = BLOCK_DISTANT_LIGHTS) uniform DistantLights { vec4 distant_lights[MOST_DISTANT_LIGHTS]; };
uniform int distant_count;

// The part that reaches a place.
vec3 unoccluded(vec3 place, vec3 normal) {
  vec3 all = vec3(0), reached = vec3(0);
  ivec2 last = textureSize(distant_shadows, 0).xy - 1;
  for (int k = 0; k < distant_count; ++k) {
    LightFace f = distant_faces[k];
    float cosine = -dot(normal, f.ahead.xyz);
    if (cosine <= 0) continue;
    vec3 there = cosine * distant_lights[k].rgb;
    all += there;
    Seen s = seen_by(f, place, normal);
    ivec2 texel = clamp(ivec2((0.5 + 0.5 * s.at.xy) * (last + 1)), ivec2(0), last);
    vec3 centre = vec3(2 * (vec2(texel) + 0.5) / (last + 1) - 1, 1);
    if (!is_behind(s, f, texelFetch(distant_shadows, ivec3(texel, k), 0).xyz, centre)) reached += there;
  }
  return mix(vec3(1), reached / all, greaterThan(all, vec3(0)));
}
