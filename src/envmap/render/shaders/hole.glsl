// Whether the texture of a material with an alpha_cutoff has a hole here. Visibility is all or nothing, so it is asked of
// the finest level.
bool is_hole(uint triangle, vec3 ray) {
  Material material = materials[instances[instance].material];
  Triangle t = triangle_of(instance, triangle);
  float alpha = material.base_colour.a;
  if (material.base_colour_texture != 0)
    alpha *= textureLod(base_colours, coordinates_at(t, inside(weights_of(t, ray))), 0).a;
  return alpha < material.emissive.a;
}
