// Draws a triangle with straight sides between the images of its corners. A triangle that holds the singularity has its
// image outside of these sides. There its winding in the image differs from its winding as seen, and it is left out.
layout(triangles) in;
layout(triangle_strip, max_vertices = 3) out;
in vec3 placed[];
#if TESSELLATED
flat in uint number[];
#endif
flat out uint triangle;
layout(std430, binding = BUFFER_MISSING) buffer Missing { uint missing; };  // In 2^-20 steradians, rounded up.
uniform bool counts;

void count(vec3 a, vec3 b, vec3 c, float height) {
  // Triangles beyond the near and the far sphere would not have been drawn.
  bool within = height < range.y && max(length(a), max(length(b), length(c))) > range.x;
  if (counts && within) atomicAdd(missing, uint(ceil(solid_angle(a, b, c) * exp2(20))));
}

void emit(vec4 at) {
  gl_Position = at;
#if TESSELLATED
  triangle = number[0];
#else
  triangle = uint(first_triangle + gl_PrimitiveIDIn);
#endif
  EmitVertex();
}

void main() {
  vec3 normal = cross(placed[1] - placed[0], placed[2] - placed[0]);
  float height = dot(normal, placed[0]);
  // Seen edge on, or from behind.
  if (height == 0 || facing * height > 0) return;
  vec3 a = to_face * placed[0], b = to_face * placed[1], c = to_face * placed[2];
#if FILLED
  // Directions beyond the image are a cone, which holds all of a triangle whose corners it holds.
  if (all(lessThan(vec3(normalize(a).z, normalize(b).z, normalize(c).z), vec3(cos(REACH))))) return;
#endif
  vec4 p = distorted(a), q = distorted(b), r = distorted(c);
  // Rows of the image run down, and its frame may be mirrored.
  float winding = -determinant(mat3(p.xyw, q.xyw, r.xyw)) * determinant(to_face);
  if (winding * height <= 0) {
    count(a, b, c, abs(height) / length(normal));
    return;
  }
  emit(p);
  emit(q);
  emit(r);
}
