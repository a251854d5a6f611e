
#if TESSELLATED
flat in uint triangle;
#else
uint triangle = uint(first_triangle + gl_PrimitiveID);
#endif

void main() {
  if (gl_FragCoord.z * range.y < range.x) discard;
#if LAYERED
  if (is_done(gl_FragCoord.z)) discard;
#endif
#if HOLES
  if (is_hole(triangle, ray_at(ivec2(gl_FragCoord.xy)))) discard;
#endif
  surface = uvec2(instance + 1, triangle);
}
