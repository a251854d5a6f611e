layout(binding = 0) uniform sampler2D rays;

void main() {
  if (gl_FragCoord.z * range.y < range.x) discard;
#ifdef HOLES
  if (is_hole(uint(first_triangle + gl_PrimitiveID), texelFetch(rays, ivec2(gl_FragCoord.xy), 0).xyz)) discard;
#endif
  surface = uvec2(instance + 1, first_triangle + gl_PrimitiveID);
}
