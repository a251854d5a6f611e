// What surfaces without a map of their own reflect.
vec3 reflected(vec3 from, vec3 normal, float bend) { return environment_at(from); }
