// Vertices in the image of a light, the viewpoint in its centre.
layout(location = 0) in vec3 position;
uniform int light_face;

void main() {
  ShadowView f = shadow_views[light_face];
  vec3 p = to_light(f, (to_map * vec4(position, 1)).xyz);
  vec2 at = p.xy / f.lens.x;
  gl_Position = is_parallel(f) ? vec4(at, 0.5 - 0.5 * p.z / f.lens.x, 1) : vec4(at, f.lens.z, p.z);
}
