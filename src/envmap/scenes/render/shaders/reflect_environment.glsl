// What surfaces without a map of their own reflect.
const float beyond = 0, way = 1e30;  // Of reflect_mirror.glsl.

vec3 reflected(vec3 from, vec3 normal, float bend) { return environment_at(from); }
