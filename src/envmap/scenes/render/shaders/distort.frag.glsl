flat in uint triangle;

void main() {
#if !FILLED
  // Triangles that reach to infinity cross the rim of the disc.
  if (ray_at(ivec2(gl_FragCoord.xy)).along == vec3(0)) discard;
#endif
  if (gl_FragCoord.z * range.y < range.x) discard;
#if LAYERED
  if (is_done(gl_FragCoord.z)) discard;
#endif
#if HOLES
  if (is_hole(triangle, ray_at(ivec2(gl_FragCoord.xy)))) discard;
#endif
  surface = uvec2(instance + 1, triangle);
}
