// projection/octahedral.h
vec3 octahedral_located(vec3 d) {
  vec3 size = abs(d) / (abs(d.x) + abs(d.y) + abs(d.z));
  vec2 at = d.y < 0 ? 1 - size.zx : size.xz;
  return vec3(0.5 + (d.x < 0 ? -0.5 : 0.5) * at.x, 0.5 - (d.z < 0 ? -0.5 : 0.5) * at.y, 0);
}
