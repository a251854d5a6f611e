// Whether the texture of a material with an alpha_cutoff has a hole here. Visibility is all or nothing, so it is asked of
// the finest level.
uniform int material;
uniform bool textured;

bool is_hole(uint triangle, vec3 ray) {
  Triangle t = triangle_of(instance, triangle);
  float alpha = texelFetch(materials, 4 * material).a;
  if (textured) alpha *= textureLod(base_colours, t.places * inside(weights_of(t, ray)), 0).a;
  return alpha < texelFetch(materials, 4 * material + 1).a;
}
