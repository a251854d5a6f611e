// Whether the texture of a material with an alpha_cutoff has a hole here. Visibility is all or nothing, so it is asked of
// the finest level.
uniform int material;
uniform bool textured;

bool is_hole(uint triangle, vec3 ray) {
  Triangle t = triangle_of(instance, triangle);
  vec3 weights = inside(weights_of(t, ray));
  float alpha = texelFetch(materials, 4 * material).a * colour_of(triangle, weights).a;
  if (textured) alpha *= textureLod(base_colours, t.places * weights, 0).a;
  return alpha < texelFetch(materials, 4 * material + 1).a;
}
