in vec3 placed;
layout(binding = UNIT_RAYS) uniform sampler2D rays;

void main() {
  float distance = length(placed);
  if (distance < range.x || distance > range.y) discard;
#if LAYERED
  if (is_done(gl_FragCoord.z)) discard;
#endif
#if HOLES
  if (is_hole(uint(first_triangle + gl_PrimitiveID), texelFetch(rays, ivec2(gl_FragCoord.xy), 0).xyz)) discard;
#endif
  surface = uvec2(instance + 1, first_triangle + gl_PrimitiveID);
}
