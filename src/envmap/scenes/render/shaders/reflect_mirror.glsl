// What a mirror reflects: its own map (mirror_*.glsl), looked up by the direction alone, as if all were far away, or where
// the ray meets it (meet_map.glsl).
uniform mat3 to_mirror;    // From the world.
uniform vec3 from_middle;  // Of the map to the viewpoint.
uniform vec3 behind;        // Light of infinity beside the environment's.
uniform int images;        // 1: a flat mirror, seen by another mirror's map (MirrorLook::images).

float beyond = 0;  // How far behind the surface the image of what it reflects is.
float way = 1e30;  // From the surface to what a lens shows, where the map tells.

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
  if (reflects_only) return tint(face_of(place_by_vertex)) * mirror_at_place(place_by_vertex, 0).rgb;
  vec3 d = to_mirror * from;
  return tint(face_of(place_of(d))) * mirror_at(d, 0).rgb;
#else
  vec3 d[3], next[2];
  vec3 p = from_map(here.position), r = to_mirror * from;
  float far_off = max(length(p), 1e-20), part = BY_DISTANCE != 0 ? met(p, far_off * r) : 1;
  float met_at = far_off * part / max(1 - part, 1e-9);
  if (images != 0 && bend == 0) beyond = met_at;
  if (BY_DISTANCE != 0 && bend != 0) way = met_at;
  d[0] = normalize(mix(p, far_off * r, part));
  for (int k = 0; k < 2; ++k) {
    next[k] = turned(beside[k].ray, normalize(normal + beside[k].normal), bend);
    d[k + 1] = normalize(mix(from_map(beside[k].position), far_off * to_mirror * next[k], part));
  }
  vec4 shown = mirror_over(d[0], d[1] - d[0], d[2] - d[0]);
  if (shown.a < 0.9999) {
    // Samples lie in columns of even width (sample_offset()): each stands for its column, and together they are the pixel.
    vec3 across = spread * (next[0] - from), down = (next[1] - from) / spread, ray = from - below_centre * down;
    vec3 map_across = spread * (d[1] - d[0]), map_down = (d[2] - d[0]) / spread, map_ray = d[0] - below_centre * map_down;
    ivec2 count = samples_over(across, down);
    vec4 sum = vec4(0);
    for (int k = 0; k < count.x * count.y; ++k) {
      vec2 aside = sample_aside(k, count);
      // The environment shows only in the part of the pixel that no surface covers.
      float open = shown.a <= 0 ? 1 : 1.0001 - mirror_at(normalize(map_ray + aside.x * map_across + aside.y * map_down), 0).a;
      sum += open * vec4(environment_at(normalize(ray + aside.x * across + aside.y * down)), 1);
    }
    shown.rgb += (1 - shown.a) * (behind + sum.rgb / sum.a);
  }
  return tint(face_of(place_of(d[0]))) * shown.rgb;
#endif
}
