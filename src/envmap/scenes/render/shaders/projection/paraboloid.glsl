// projection/paraboloid.h
float paraboloid_radius(float angle) { return tan(0.5 * min(angle, 3.1)); }

// One half goes on beyond its rim.
vec3 paraboloid_half(vec3 d, int face) {
  vec2 at = d.xy / (1 + (face == 0 ? d.z : -d.z));
  return vec3(0.5 + 0.5 * at.x, 0.5 - 0.5 * at.y, face);
}

vec3 paraboloid_located(vec3 d) { return paraboloid_half(d, d.z < 0 ? 1 : 0); }
