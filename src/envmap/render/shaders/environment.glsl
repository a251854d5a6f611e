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

// The mean over what a texel or a pixel shows.
// @param across, down how it changes from this texel to the next.
vec3 environment_over(vec3 ray, vec3 across, vec3 down) {
  vec2 n = ceil(samples_a_texel * vec2(length(across), length(down)) / environment_texel);
  n = clamp(n, 1, most_samples);
  ivec2 count = ivec2(max(n * min(1, sqrt(most_samples / (n.x * n.y))), 1));
  vec3 sum = vec3(0);
  for (int k = 0; k < count.x * count.y; ++k) {
    vec2 aside = (vec2(k % count.x, k / count.x) + 0.5) / count - 0.5;
    sum += environment_at(normalize(ray + aside.x * across + aside.y * down));
  }
  return sum / (count.x * count.y);
}
