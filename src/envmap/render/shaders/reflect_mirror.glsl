// What a mirror reflects: its own map (mirror_*.glsl), looked up by the direction alone, as if all were far away, or where
// the ray meets it (meet_map.glsl).
uniform mat3 to_mirror;    // From the world.
uniform vec3 from_middle;  // Of the map to the viewpoint.

#if BY_VERTEX
vec3 place_by_vertex;  // Where the surface was interpolated to look.
bool reflects_only;    // Not so for lenses.
#endif

#if BY_DISTANCE
vec3 seen_from;  // The surface, in the frame of the map.
#endif

vec3 reflected(vec3 from) {
#if BY_VERTEX
  if (reflects_only) return mirror_at_place(place_by_vertex);
#endif
#if BY_DISTANCE
  return mirror_at(normalize(met(seen_from, to_mirror * from)));
#else
  return mirror_at(to_mirror * from);
#endif
}
