// Whether the texture of a material with an alpha_cutoff has a hole here. Visibility is all or nothing, so it is asked of
// the finest level.
uniform int material;
uniform bool textured;

// @param weights of the corners.
bool is_hole(uint triangle, Triangle t, vec3 weights) {
  float alpha = texelFetch(materials, MATERIAL * material).a * colour_of(triangle, weights).a;
  if (textured) alpha *= textureLod(base_colours, t.places * weights, 0).a;
  return alpha < texelFetch(materials, MATERIAL * material + 1).a;
}

bool is_hole(uint triangle, Ray ray) {
  Triangle t = triangle_of(instance, triangle, ray.from);
  return is_hole(triangle, t, inside(weights_of(t, ray.along)));
}
