// projection/equal_area.h
vec3 equal_area_located(vec3 d) {
  float across = length(d.xz), r = across / sqrt(1 + abs(d.y));
  float b = across > 0 ? r * atan(abs(d.z), abs(d.x)) / (0.5 * PI) : 0;
  vec2 at = d.y < 0 ? vec2(1 - b, 1 - (r - b)) : vec2(r - b, b);
  return vec3(0.5 + (d.x < 0 ? -0.5 : 0.5) * at.x, 0.5 - (d.z < 0 ? -0.5 : 0.5) * at.y, 0);
}
