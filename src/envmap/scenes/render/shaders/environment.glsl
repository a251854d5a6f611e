// The environment, from far away. Its faces come with the apron of a PaddedLevel, so plain filtering knows no seams.
layout(binding = UNIT_ENVIRONMENT) uniform sampler2DArray environment;
uniform mat3 to_environment;  // From the world.

vec3 environment_at(vec3 direction) {
  vec3 at = ENVIRONMENT_LOCATED(to_environment * direction);
  vec2 size = vec2(textureSize(environment, 0).xy);
  return textureLod(environment, vec3((APRON + at.xy * (size - 2 * APRON)) / size, at.z), 0).rgb;
}

uniform float environment_texel;  // Radians.
const float samples_a_texel = 3;
const float most_samples = 64;

// How many samples across and down a texel or a pixel. @param across, down how the direction changes to the next one.
ivec2 samples_over(vec3 across, vec3 down) {
  vec2 n = clamp(ceil(samples_a_texel * vec2(length(across), length(down)) / environment_texel), 1, most_samples);
  float fewer = min(min(n.x, n.y), sqrt(most_samples)), more = min(max(n.x, n.y), floor(most_samples / fewer));
  return ivec2(n.x < n.y ? vec2(fewer, more) : vec2(more, fewer));
}

// The distance of sample k from the middle, as a part of the whole.
vec2 sample_aside(int k, ivec2 count) { return (vec2(k % count.x, k / count.x) + 0.5) / count - 0.5; }

// The mean over what a texel or a pixel shows. @param across, down as above.
vec3 environment_over(vec3 ray, vec3 across, vec3 down) {
  ivec2 count = samples_over(across, down);
  vec3 sum = vec3(0);
  for (int k = 0; k < count.x * count.y; ++k) {
    vec2 aside = sample_aside(k, count);
    sum += environment_at(normalize(ray + aside.x * across + aside.y * down));
  }
  return sum / (count.x * count.y);
}
