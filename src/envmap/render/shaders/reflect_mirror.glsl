// What a mirror reflects: its own map (mirror_*.glsl), looked up by the direction alone, so of surroundings that are far
// away.
uniform mat3 to_mirror;  // From the world.

#if BY_VERTEX
vec3 place_by_vertex;  // Where the surface was interpolated to look.
bool reflects_only;    // Not so for lenses.
#endif

vec3 reflected(vec3 from) {
#if BY_VERTEX
  if (reflects_only) return mirror_at_place(place_by_vertex);
#endif
  return mirror_at(to_mirror * from);
}
