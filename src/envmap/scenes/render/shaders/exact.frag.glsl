// The ray of the texel against the triangle itself: its sides by the sign of three products, which neighbours share to
// the last bit, and its distance from its plane.
flat in mat3 sides;
flat in vec4 plane;
flat in uint triangle;

void main() {
  vec3 ray = ray_at(ivec2(gl_FragCoord.xy)).along;
  vec3 side = ray * sides;
  if (min(side.x, min(side.y, side.z)) < 0 && max(side.x, max(side.y, side.z)) > 0) discard;
  float distance = plane.w / dot(ray, plane.xyz);
  if (!(distance >= range.x && distance <= range.y)) discard;
#if LAYERED
  if (is_done(range.x / distance)) discard;
#endif
#if HOLES
  if (is_hole(triangle, Ray(vec3(0), ray))) discard;
#endif
  gl_FragDepth = range.x / distance;
  surface = uvec2(instance + 1, triangle);
}
