layout(location = 0) in vec3 position;

void main() {
  gl_Position = distorted(to_face * (to_map * vec4(position, 1)).xyz);
}
