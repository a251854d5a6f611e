// What a mirror reflects: its own map (mirror_*.glsl), looked up by the direction alone, as if all were far away, or where
// the ray meets it (meet_map.glsl).
uniform mat3 to_mirror;    // From the world.
uniform vec3 from_middle;  // Of the map to the viewpoint.
uniform int images;        // 1: a flat mirror, seen by another mirror's map (MirrorLook::images).

float beyond = 0;  // How far behind the surface the image of what it reflects is.

#if BY_VERTEX
vec3 place_by_vertex;  // Where the surface was interpolated to look.
bool reflects_only;    // Not so for lenses.
#else
// The surface here, and how it goes on to the next texels across and down; there the normal is how it changes.
struct Beside {
  vec3 position, normal, ray;
};
Beside here, beside[2];

// From the middle of the map, in its frame.
vec3 from_map(vec3 position) { return to_mirror * (from_middle + position); }
#endif

// @param normal that turned the ray there.
vec3 reflected(vec3 from, vec3 normal, float bend) {
#if BY_VERTEX
  return reflects_only ? mirror_at_place(place_by_vertex, 0) : mirror_at(to_mirror * from, 0);
#else
  vec3 d[3];
  vec3 p = from_map(here.position), r = to_mirror * from;
  float far_off = max(length(p), 1e-20), part = BY_DISTANCE != 0 ? met(p, far_off * r) : 1;
  if (images != 0 && bend == 0) beyond = far_off * part / max(1 - part, 1e-9);
  d[0] = normalize(mix(p, far_off * r, part));
  for (int k = 0; k < 2; ++k)
    d[k + 1] = normalize(mix(from_map(beside[k].position),
                             far_off * to_mirror * turned(beside[k].ray, normalize(normal + beside[k].normal), bend), part));
  return mirror_over(d[0], d[1] - d[0], d[2] - d[0]);
#endif
}
