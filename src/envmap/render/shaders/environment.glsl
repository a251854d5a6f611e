// The environment, from far away. Its faces come with the apron of a PaddedLevel, so plain filtering knows no seams.
layout(binding = UNIT_ENVIRONMENT) uniform sampler2DArray environment;
uniform mat3 to_environment;  // From the world.

vec3 environment_at(vec3 direction) {
  vec3 at = ENVIRONMENT_LOCATED(to_environment * direction);
  vec2 size = vec2(textureSize(environment, 0).xy);
  return textureLod(environment, vec3((APRON + at.xy * (size - 2 * APRON)) / size, at.z), 0).rgb;
}
