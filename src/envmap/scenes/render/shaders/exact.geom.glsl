// A rectangle round what each triangle may cover, with all that a fragment needs to meet the triangle itself.
layout(triangles) in;
layout(triangle_strip, max_vertices = 8) out;
in vec3 placed[];
flat out mat3 sides;   // Normals of the planes through the viewpoint and ab, bc, ca.
flat out vec4 plane;   // Normal of the triangle, and its product with any of its points.
flat out uint triangle;

void emit_corner(vec2 at, mat3 n, vec4 p) {
  gl_Position = vec4(vec2(at.x, -at.y) + shift, 0.5, 1);  // Rows run from the top.
  sides = n;
  plane = p;
  triangle = uint(first_triangle + gl_PrimitiveIDIn);
  EmitVertex();
}

void emit_rectangle(Rectangle r, mat3 n, vec4 p) {
  emit_corner(r.centre - r.along - r.across, n, p);
  emit_corner(r.centre + r.along - r.across, n, p);
  emit_corner(r.centre - r.along + r.across, n, p);
  emit_corner(r.centre + r.along + r.across, n, p);
  EndPrimitive();
}

// a x b, so that b x a is the same but for its sign to the last bit, and close points lose no digits.
vec3 side(vec3 a, vec3 b) { return 0.5 * cross(a + b, b - a); }

void main() {
  vec3 a = placed[0], b = placed[1], c = placed[2];
  vec3 normal = cross(b - a, c - a);
  float height = dot(normal, a);
  // Seen edge on, or from behind.
  if (height == 0 || facing * height > 0) return;
  mat3 n = mat3(side(a, b), side(b, c), side(c, a));
  vec4 p = vec4(normal, height);
  a = to_face * a;
  b = to_face * b;
  c = to_face * c;
#if SHAPE == PLANE
  Rectangle r = rectangle_of(a, b, c, range.x);
  if (r.along != vec2(0)) emit_rectangle(r, n, p);
#else
  Angles angles = angles_of(a, b, c, determinant(to_face) * to_face * n, determinant(to_face) * height);
#if SHAPE == BAND
  emit_rectangle(rectangle_of(angles, 0), n, p);
  if (angles.round_it.x < -PI) emit_rectangle(rectangle_of(angles, 2 * PI), n, p);
  if (angles.round_it.y > PI) emit_rectangle(rectangle_of(angles, -2 * PI), n, p);
#else
  Rectangle r = rectangle_of(angles);
  if (r.along != vec2(0)) emit_rectangle(r, n, p);
#endif
#endif
}
