// A triangle of the scene by its numbers, and where a ray meets it.
struct Material {
  vec4 base_colour;
  vec4 emissive;           // And the alpha below which there is a hole.
  float metallic, roughness, transmission, ior;
  int base_colour_texture, metallic_roughness_texture, emissive_texture;  // 0: none.
  int group;               // Materials of the same textures.
};
layout(std430, binding = 1) readonly buffer Materials { Material materials[]; };
layout(std430, binding = 2) readonly buffer Indices { uint indices[]; };
layout(std430, binding = 3) readonly buffer Vertices { float vertices[]; };  // Position, normal, texture coordinates.
layout(binding = 1) uniform sampler2D base_colours;
layout(binding = 2) uniform sampler2D metallic_roughnesses;
layout(binding = 3) uniform sampler2D emissives;

struct Triangle {
  ivec3 at;        // Of its vertices' first numbers.
  vec3 a, b, c;    // In the frame of the map.
  mat3 sides;      // Opposite a, b and c: normals of the planes through the viewpoint, towards the inside.
  vec3 normal;
  float height;    // Of the viewpoint over its plane times twice its area; negative where it is seen from the front.
};

vec3 three(int at) { return vec3(vertices[at], vertices[at + 1], vertices[at + 2]); }
vec2 coordinates(int at) { return vec2(vertices[at + 6], vertices[at + 7]); }
vec3 side_of(vec3 a, vec3 b) { return 0.5 * cross(a + b, b - a); }

Triangle triangle_of(int number, uint which) {
  Triangle t;
  int first = instances[number].first_index + 3 * int(which);
  t.at = 8 * ivec3(indices[first], indices[first + 1], indices[first + 2]);
  mat4 to_map = instances[number].to_map;
  t.a = (to_map * vec4(three(t.at.x), 1)).xyz;
  t.b = (to_map * vec4(three(t.at.y), 1)).xyz;
  t.c = (to_map * vec4(three(t.at.z), 1)).xyz;
  t.normal = cross(t.b - t.a, t.c - t.a);
  t.height = dot(t.normal, t.a);
  t.sides = mat3(side_of(t.b, t.c), side_of(t.c, t.a), side_of(t.a, t.b)) * (t.height < 0 ? -1.0 : 1.0);
  return t;
}

// What each corner counts for where the ray meets the plane, by volumes: they do not sum to 1, and are all positive
// inside.
vec3 weights_of(Triangle t, vec3 ray) { return ray * t.sides; }

// To within the triangle: methods that move vertices show it where the ray misses it.
vec3 inside(vec3 weights) {
  weights = max(weights, 0);
  float sum = weights.x + weights.y + weights.z;
  return sum > 0 ? weights / sum : vec3(1.0 / 3);
}

vec2 coordinates_at(Triangle t, vec3 weights) {
  return mat3x2(coordinates(t.at.x), coordinates(t.at.y), coordinates(t.at.z)) * weights;
}
