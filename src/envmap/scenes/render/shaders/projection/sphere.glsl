// projection/sphere.h
float sphere_radius(float angle) { return sin(0.5 * angle); }

vec3 sphere_located(vec3 d) {
  vec2 at = d.z > 0 ? d.xy * inversesqrt(2 * (1 + d.z))
                    : (d.xy == vec2(0) ? vec2(1, 0) : normalize(d.xy)) * sqrt(0.5 * (1 - d.z));
  return vec3(0.5 + 0.5 * at.x, 0.5 - 0.5 * at.y, 0);
}
