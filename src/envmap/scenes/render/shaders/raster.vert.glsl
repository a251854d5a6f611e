// A face of a cube, or a picture, the usual way: straight sides stay straight.
layout(location = 0) in vec3 position;
uniform vec4 frame;  // How much is seen: a factor across and one up, a shift to the right; and the near plane.
uniform bool parallel;  // The same in metres; depth falls to 0 at the far plane.
uniform vec4 before;    // Nothing is drawn where its product with (placed, 1) is below 0.
out vec3 placed;
out float gl_ClipDistance[1];

void main() {
  placed = (to_map * vec4(position, 1)).xyz;
  gl_ClipDistance[0] = dot(before, vec4(placed, 1));
  vec3 p = to_face * placed;
  // There is no far plane.
  if (parallel)
    gl_Position = vec4(vec2(frame.x * p.x, -frame.y * p.y) + shift, 1 - p.z / range.y, 1);
  else
    gl_Position = vec4(vec2(frame.x * p.x + frame.z * p.z, -frame.y * p.y) + shift * p.z, frame.w, p.z);
}
