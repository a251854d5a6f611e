// The plane of what a light sees first.
layout(location = 0) out vec4 plane;
uniform int light_face;
uniform vec2 pixel;  // Of the image, in clip space.

void main() {
  ShadowView f = shadow_views[light_face];
  uint which = uint(first_triangle + gl_PrimitiveID);
  Triangle t = triangle_of(instance, which, vec3(0));
  vec3 n = to_light(f, normalize(t.normal));
  vec3 seen = plane_seen(f, n, dot(n, to_light(f, t.a)));
#if HOLES
  vec2 at = pixel * gl_FragCoord.xy - 1;
  float nearness = dot(seen, vec3(at, 1)), depth = is_parallel(f) ? -nearness : 1 / nearness;
  vec2 across = f.lens.x * at * (is_parallel(f) ? 1 : depth);
  if (is_hole(which, t, inside(weights_at(t, across.x * f.right.xyz + across.y * f.up.xyz + depth * f.ahead.xyz)))) discard;
#endif
  plane = vec4(seen, 0);
}
