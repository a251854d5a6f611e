// projection/angular.h
float angular_radius(float angle) { return angle / PI; }

vec3 angular_located(vec3 d) {
  float across = length(d.xy);
  vec2 at = across > 0 ? d.xy / across * angular_radius(atan(across, d.z)) : vec2(d.z > 0 ? 0 : -1, 0);
  return vec3(0.5 - 0.5 * at.x, 0.5 - 0.5 * at.y, 0);
}
