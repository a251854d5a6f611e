// projection/cube.h
vec3 cube_located(vec3 d) {
  vec3 size = abs(d);
  int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
  bool negative = d[axis] < 0;
  vec2 at = axis == 0 ? vec2(negative ? -d.z : d.z, d.y)
          : axis == 1 ? vec2(d.x, negative ? -d.z : d.z)
                      : vec2(negative ? d.x : -d.x, d.y);
  at /= size[axis];
  return vec3(0.5 + 0.5 * at.x, 0.5 - 0.5 * at.y, 2 * axis + (negative ? 1 : 0));
}
