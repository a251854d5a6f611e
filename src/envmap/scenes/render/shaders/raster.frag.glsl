uniform bool parallel;
in vec3 placed;

void main() {
  float distance = parallel ? -placed.z : length(placed);
  if (distance < range.x || distance > range.y) discard;
#if LAYERED
  if (is_done(gl_FragCoord.z)) discard;
#endif
#if HOLES
  if (is_hole(uint(first_triangle + gl_PrimitiveID), ray_at(ivec2(gl_FragCoord.xy)))) discard;
#endif
  surface = uvec2(instance + 1, first_triangle + gl_PrimitiveID);
}
