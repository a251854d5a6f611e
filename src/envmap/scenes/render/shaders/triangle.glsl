// A triangle of the scene by its numbers, and where a ray meets it. Buffer textures: llvmpipe fetches four floats as
// fast as one, and storage buffers one by one.
layout(binding = UNIT_CORNERS) uniform samplerBuffer corners;    // Position and u, normal and v, colour; three corners a triangle.
layout(binding = UNIT_TANGENTS) uniform samplerBuffer tangents;    // Of the corners of scenes with normal maps; w: see scene.h.
layout(binding = UNIT_INSTANCES) uniform samplerBuffer instances;  // Three rows to the frame of the map, three to the world's normals.
layout(binding = UNIT_MATERIALS) uniform samplerBuffer materials;  // Base colour; emissive and alpha_cutoff; metallic, roughness, transmission, ior; bend, scale of normals, strength of occlusion; sheen; coat; absorption and thickness.
layout(binding = UNIT_BASE_COLOUR) uniform sampler2D base_colours;
layout(binding = UNIT_METALLIC_ROUGHNESS) uniform sampler2D metallic_roughnesses;
layout(binding = UNIT_EMISSIVE) uniform sampler2D emissives;
layout(binding = UNIT_NORMAL) uniform sampler2D normal_maps;
layout(binding = UNIT_OCCLUSION) uniform sampler2D occlusions;
layout(binding = UNIT_COAT) uniform sampler2D coats;
layout(binding = UNIT_COAT_ROUGHNESS) uniform sampler2D coat_roughnesses;
layout(binding = UNIT_SHEEN) uniform sampler2D sheens;
layout(binding = UNIT_SHEEN_ROUGHNESS) uniform sampler2D sheen_roughnesses;
layout(binding = UNIT_COAT_NORMAL) uniform sampler2D coat_normal_maps;

struct Triangle {
  vec3 a, b, c;    // In the frame of the map, from where rays start.
  mat3 normals;    // Of the corners, in the frame of the mesh.
  mat3x2 places;   // Texture coordinates of the corners.
  mat3 sides;      // Opposite a, b and c: normals of the planes through the viewpoint, towards the inside.
  vec3 normal;
  float height;    // Of the viewpoint over its plane times twice its area; negative where it is seen from the front.
};

vec3 side_of(vec3 a, vec3 b) { return 0.5 * cross(a + b, b - a); }

mat3x4 to_frame_of(int number) {
  return mat3x4(texelFetch(instances, 6 * number), texelFetch(instances, 6 * number + 1), texelFetch(instances, 6 * number + 2));
}

// @param from where rays start, in the frame of the map: the origin of what is returned.
Triangle triangle_of(int number, uint which, vec3 from) {
  Triangle t;
  int first = 3 * CORNER * int(which), second = first + CORNER, third = second + CORNER;
  vec4 a = texelFetch(corners, first), b = texelFetch(corners, second), c = texelFetch(corners, third);
  vec4 na = texelFetch(corners, first + 1), nb = texelFetch(corners, second + 1), nc = texelFetch(corners, third + 1);
  mat3x4 to_frame = to_frame_of(number);
  t.places = mat3x2(a.w, na.w, b.w, nb.w, c.w, nc.w);
  t.normals = mat3(na.xyz, nb.xyz, nc.xyz);
  t.a = vec4(a.xyz, 1) * to_frame - from;
  t.b = vec4(b.xyz, 1) * to_frame - from;
  t.c = vec4(c.xyz, 1) * to_frame - from;
  t.normal = cross(t.b - t.a, t.c - t.a);
  t.height = dot(t.normal, t.a);
  t.sides = mat3(side_of(t.b, t.c), side_of(t.c, t.a), side_of(t.a, t.b)) * (t.height < 0 ? -1.0 : 1.0);
  return t;
}

// Of a place that the corners count so much for.
vec4 colour_of(uint which, vec3 weights) {
  int first = 3 * CORNER * int(which) + 2;
  return mat3x4(texelFetch(corners, first), texelFetch(corners, first + CORNER), texelFetch(corners, first + 2 * CORNER)) * weights;
}

// The same, in the frame of the map.
vec4 tangent_of(int number, uint which, vec3 weights) {
  int first = 3 * int(which);
  vec4 t = mat3x4(texelFetch(tangents, first), texelFetch(tangents, first + 1), texelFetch(tangents, first + 2)) * weights;
  return vec4(vec4(t.xyz, 0) * to_frame_of(number), t.w);
}

// What each corner counts for where the ray meets the plane, by volumes: they do not sum to 1, and are all positive
// inside.
vec3 weights_of(Triangle t, vec3 ray) { return ray * t.sides; }

// The same of a point of the plane, by areas.
vec3 weights_at(Triangle t, vec3 p) {
  vec3 a = t.a - p, b = t.b - p, c = t.c - p;
  return vec3(dot(cross(b, c), t.normal), dot(cross(c, a), t.normal), dot(cross(a, b), t.normal));
}

// To within the triangle: methods that move vertices show it where the ray misses it.
vec3 inside(vec3 weights) {
  weights = max(weights, 0);
  float sum = weights.x + weights.y + weights.z;
  return sum > 0 ? weights / sum : vec3(1.0 / 3);
}
