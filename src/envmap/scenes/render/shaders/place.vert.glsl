// Vertices in the frame of the map.
layout(location = 0) in vec3 position;
out vec3 placed;

void main() {
  placed = (to_map * vec4(position, 1)).xyz;
}
