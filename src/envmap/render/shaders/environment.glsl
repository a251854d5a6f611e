// The environment, from far away. Its faces come with the apron of a PaddedLevel, so plain filtering knows no seams.
#ifdef MAP
layout(binding = 4) uniform sampler2DArray environment;
uniform mat3 to_environment;  // From the world.
const float apron = 3;

vec3 environment_at(vec3 direction) {
  vec3 at = located(to_environment * direction);
  vec2 size = vec2(textureSize(environment, 0).xy);
  return textureLod(environment, vec3((apron + at.xy * (size - 2 * apron)) / size, at.z), 0).rgb;
}
#else
vec3 environment_at(vec3 direction) { return vec3(0); }
#endif
