// What a mirror shows: its own map, looked up by the direction alone, so of surroundings that are far away. MIRROR is the
// map's projection (see locate.glsl). Parts of shading.glsl's glossy_radiance().
#ifdef MIRROR
#define OWN_GLOSSY_RADIANCE
uniform mat3 to_mirror;  // From the world.
uniform bool tinted;
#if MIRROR == 1
layout(binding = 11) uniform samplerCube mirror;  // Z mirrored: MapTexture::layer().
#else
layout(binding = 11) uniform sampler2DArray mirror;
#endif
#ifdef MIRROR_GLOSSY
layout(binding = 12) uniform samplerCubeArray mirror_glossy;
#endif

// Faces in colours that tell them apart.
vec3 tint(int face) {
  if (!tinted) return vec3(1);
  const vec3 warm = vec3(1.25, 0.85, 0.65), cold = vec3(0.65, 0.85, 1.25);
  return (face & 1) == 0 ? (face == 2 ? warm.grb : face == 4 ? warm.bgr : warm)
                         : (face == 3 ? cold.grb : face == 5 ? cold.bgr : cold);
}

#if MIRROR == 3
vec3 half_at(vec2 at, int face) {
  return tint(face) * textureLod(mirror, vec3(0.5 + 0.5 * at.x, 0.5 - 0.5 * at.y, face), 0).rgb;
}
#endif

// By a place (s, t, face) in the map, which some methods interpolate between vertices; of a cube the direction itself.
vec3 place_of(vec3 d) {
#if MIRROR == 1
  return d;
#elif MIRROR == 2
  vec2 at = d.z > 0 ? d.xy * inversesqrt(2 * (1 + d.z))
                    : (d.xy == vec2(0) ? vec2(1, 0) : normalize(d.xy)) * sqrt(0.5 * (1 - d.z));
  return vec3(at, 0);
#else
  return vec3(d.xy / (1 + abs(d.z)), d.z < 0 ? 1 : 0);
#endif
}

vec3 mirror_at_place(vec3 at) {
#if MIRROR == 1
  vec3 size = abs(at);
  int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
  return tint(2 * axis + (at[axis] < 0 ? 1 : 0)) * textureLod(mirror, vec3(at.xy, -at.z), 0).rgb;
#elif MIRROR == 2
  // Beyond the rim there is nothing; a filter must not read it.
  float most = 1 - 3.0 / textureSize(mirror, 0).x, r = length(at.xy);
  vec2 within = r > most ? at.xy * most / r : at.xy;
  return tint(0) * textureLod(mirror, vec3(0.5 + 0.5 * within.x, 0.5 - 0.5 * within.y, 0), 0).rgb;
#else
  return half_at(at.xy, int(at.z));
#endif
}

vec3 mirror_at(vec3 direction) {
  vec3 d = to_mirror * direction;
#if MIRROR == 3
  // Both halves go on beyond their rim: within a texel of it they are mixed, and there is no seam even where the square's
  // sides touch the disc.
  float texel = 2.0 / textureSize(mirror, 0).x, front = clamp(0.5 + 0.5 * d.z / texel, 0, 1);
  if (front <= 0) return half_at(d.xy / (1 - d.z), 1);
  if (front >= 1) return half_at(d.xy / (1 + d.z), 0);
  return mix(half_at(d.xy / (1 - d.z), 1), half_at(d.xy / (1 + d.z), 0), front);
#else
  return mirror_at_place(place_of(d));
#endif
}

#ifdef BY_VERTEX
vec3 place_by_vertex;  // Where the surface was interpolated to look.
bool reflects_only;    // Not so for lenses.
#endif

vec3 glossy_radiance(vec3 from, float roughness) {
#ifdef BY_VERTEX
  if (reflects_only) return mirror_at_place(place_by_vertex);
#endif
#ifdef MIRROR_GLOSSY
  const int levels = 5;
  float level = clamp(roughness, 0, 1) * levels;
  int lower = min(int(level), levels - 1);
  vec3 below = lower == 0 ? mirror_at(from) : textureLod(mirror_glossy, vec4(from, lower - 1), 0).rgb;
  return mix(below, textureLod(mirror_glossy, vec4(from, lower), 0).rgb, level - lower);
#else
  return mirror_at(from);
#endif
}
#endif
