// A face of a cube the usual way: straight sides stay straight.
layout(location = 0) in vec3 position;
out vec3 placed;

void main() {
  placed = (to_map * vec4(position, 1)).xyz;
  vec3 p = to_face * placed;
  // The near plane touches the near sphere's cube from inside; there is no far one.
  gl_Position = vec4(vec2(p.x, -p.y) + shift * p.z, 0.57 * range.x, p.z);
}
