// Where a map shows a unit direction: u, v and face. MAP is the enumerator of Projection in projection.h; the formulae are
// those of the headers beside it.
vec3 located(vec3 d) {
#if MAP == 0
  return vec3(0.5 - atan(d.x, d.z) / 6.2831853, 0.5 - atan(d.y, length(d.xz)) / 3.14159265, 0);
#elif MAP == 1
  vec3 size = abs(d);
  int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
  bool negative = d[axis] < 0;
  vec2 at = axis == 0 ? vec2(negative ? -d.z : d.z, d.y)
          : axis == 1 ? vec2(d.x, negative ? -d.z : d.z)
                      : vec2(negative ? d.x : -d.x, d.y);
  at /= size[axis];
  // +Y has +Z up, -Y has -Z up.
  return vec3(0.5 + 0.5 * at.x, 0.5 - 0.5 * at.y, 2 * axis + (negative ? 1 : 0));
#elif MAP == 2
  vec2 at = d.z > 0 ? d.xy * inversesqrt(2 * (1 + d.z))
                    : (d.xy == vec2(0) ? vec2(1, 0) : normalize(d.xy)) * sqrt(0.5 * (1 - d.z));
  return vec3(0.5 + 0.5 * at.x, 0.5 - 0.5 * at.y, 0);
#elif MAP == 3
  vec2 at = d.xy / (1 + abs(d.z));
  return vec3(0.5 + 0.5 * at.x, 0.5 - 0.5 * at.y, d.z < 0 ? 1 : 0);
#else
  float across = length(d.xy), angle = atan(across, d.z) / 3.14159265;
  vec2 at = across > 0 ? d.xy / across * angle : vec2(d.z > 0 ? 0 : 1, 0);
  return vec3(0.5 - 0.5 * at.x, 0.5 - 0.5 * at.y, 0);
#endif
}
