#ifndef ENVMAP_LOOKUPS
#define ENVMAP_LOOKUPS

#define ENVMAP_PI 3.14159265

// ---- Texture coordinates of a direction -----------------------------------------------------------------------------
//
// Directions have unit length in a right-handed world, +Y up. u runs right and v down, both in [0,1]: v = 0 is the first
// row of the file, which must be the first row of the texture. Their derivatives jump at seams: sample with an explicit
// level, or with gradients.

// The direction in an image whose centre is the horizontal axis `forward`: vec3(1.0, 0.0, 0.0) for '--forward +x'.
vec3 envmap_facing(vec3 d, vec3 forward) {
  return vec3(d.x * forward.z - d.z * forward.x, d.y, d.x * forward.x + d.z * forward.z);
}

// Latlong (equirectangular) maps. The default of envmap is forward = vec3(0.0, 0.0, 1.0).
vec2 envmap_latlong(vec3 d, vec3 forward) {
  vec3 f = envmap_facing(d, forward);
  float across = length(f.xz);
  float longitude = across > 0.0 ? atan(f.x, f.z) : 0.0;
  return vec2(0.5 - longitude / (2.0 * ENVMAP_PI), 0.5 - atan(f.y, across) / ENVMAP_PI);
}

// Angular maps (light probes, Debevec 1998).
vec2 envmap_angular(vec3 d, vec3 forward) {
  vec3 f = envmap_facing(d, forward);
  float across = length(f.xy);
  vec2 at = vec2(f.z > 0.0 ? 0.0 : 1.0, 0.0);
  if (across > 0.0) at = vec2(-f.x, f.y) * (atan(across, f.z) / (ENVMAP_PI * across));
  return vec2(0.5 + 0.5 * at.x, 0.5 - 0.5 * at.y);
}

// Sphere maps (the mirror ball of GL_SPHERE_MAP), +Z in the centre.
vec2 envmap_sphere(vec3 d) {
  float across = length(d.xy);
  vec2 at = vec2(1.0, 0.0);
  if (d.z > 0.0) at = d.xy * inversesqrt(2.0 + 2.0 * d.z);
  else if (across > 0.0) at = d.xy * (sqrt(0.5 - 0.5 * d.z) / across);
  return vec2(0.5 + 0.5 * at.x, 0.5 - 0.5 * at.y);
}

// Texture matrix of a sphere map: with h = d + (0, 0, 1), of unit length, the normal of the ball that mirrors d to an eye
// on +Z, the ball's place (h.x, h.y) is that of its picture from afar: u = 1/2 + h.x / 2 and v = 1/2 - h.y / 2, v being down.
// sphere (u, v, -, w) = M (h.x, h.y, h.z, 1):
//   | 0.5  0.0  0.0  0.5 |
//   | 0.0 -0.5  0.0  0.5 |
//   | 0.0  0.0  0.0  0.0 |
//   | 0.0  0.0  0.0  1.0 |
// d is in the frame of the map: multiply M by the rotation from eye space for normals in eye space.

// Octahedral maps (Engelhardt and Dachsbacher 2008), +Y in the centre.
vec2 envmap_octahedral(vec3 d) {
  vec3 a = abs(d) / (abs(d.x) + abs(d.y) + abs(d.z));
  vec2 at = d.y < 0.0 ? vec2(1.0 - a.z, 1.0 - a.x) : a.xz;
  return vec2(0.5 + (d.x < 0.0 ? -0.5 : 0.5) * at.x, 0.5 - (d.z < 0.0 ? -0.5 : 0.5) * at.y);
}

// Equal-area octahedral maps (Clarberg 2008), +Y in the centre.
vec2 envmap_equal_area(vec3 d) {
  float across = length(d.xz);
  float r = across / sqrt(1.0 + abs(d.y));
  float b = across > 0.0 ? r * atan(abs(d.z), abs(d.x)) / (0.5 * ENVMAP_PI) : 0.0;
  vec2 at = d.y < 0.0 ? vec2(1.0 - b, 1.0 - r + b) : vec2(r - b, b);
  return vec2(0.5 + (d.x < 0.0 ? -0.5 : 0.5) * at.x, 0.5 - (d.z < 0.0 ? -0.5 : 0.5) * at.y);
}

// Dual-paraboloid maps (Heidrich and Seidel 1998): u, v and the face, 0 in front (+Z), 1 behind.
vec3 envmap_paraboloid(vec3 d) {
  vec2 at = d.xy / (1.0 + abs(d.z));
  return vec3(0.5 + 0.5 * at.x, 0.5 - 0.5 * at.y, d.z < 0.0 ? 1.0 : 0.0);
}

// Texture matrices of paraboloid maps: z = (1 - x^2 - y^2) / 2 mirrors d to +Z at the place d.xy / (1 + d.z), because the
// normal there, (x, y, 1), halves the angle between d and +Z. u = 1/2 + x / 2 and v = 1/2 - y / 2 times w = 1 + d.z are
// linear in d, and the graphics card divides by w. Behind, -d.z stands for d.z.
// front (u, v, -, w) = M (d.x, d.y, d.z, 1):
//   | 0.5  0.0  0.5  0.5 |
//   | 0.0 -0.5  0.5  0.5 |
//   | 0.0  0.0  0.0  0.0 |
//   | 0.0  0.0  1.0  1.0 |
// back (u, v, -, w) = M (d.x, d.y, d.z, 1):
//   | 0.5  0.0 -0.5  0.5 |
//   | 0.0 -0.5 -0.5  0.5 |
//   | 0.0  0.0  0.0  0.0 |
//   | 0.0  0.0 -1.0  1.0 |
// d has unit length: the last column stands for |d|. For d in eye space multiply M by the rotation from there to the map.

// Cube maps in one 2D image: u, v and the face, 0 to 5 for +X -X +Y -Y +Z -Z, seen from inside. A cube texture of a
// KTX2, KTX or DDS file takes the direction itself.
vec3 envmap_cube(vec3 d) {
  vec3 a = abs(d);
  float most = max(a.x, max(a.y, a.z));
  vec3 at = d.z < 0.0 ? vec3(d.x, d.y, 5.0) : vec3(-d.x, d.y, 4.0);
  if (a.x == most) at = d.x < 0.0 ? vec3(-d.z, d.y, 1.0) : vec3(d.z, d.y, 0.0);
  else if (a.y == most) at = d.y < 0.0 ? vec3(d.x, -d.z, 3.0) : vec3(d.x, d.z, 2.0);
  return vec3(0.5 + 0.5 * at.x / most, 0.5 - 0.5 * at.y / most, at.z);
}

// ---- Faces in one image: from u, v and the face to u and v of the image ---------------------------------------------

// Keeps a bilinear filter inside a face of size x size texels, away from its neighbours in the image.
vec3 envmap_inset(vec3 place, float size) {
  float margin = 0.5 / size;
  return vec3(clamp(place.x, margin, 1.0 - margin), clamp(place.y, margin, 1.0 - margin), place.z);
}

// The two faces of a dual-paraboloid map, side by side.
vec2 envmap_pair(vec3 place) { return vec2(0.5 * (place.z + place.x), place.y); }

// The '--layout' of a cube: column, row, 3x2, cross and vcross.
vec2 envmap_column(vec3 place) { return vec2(place.x, (place.z + place.y) / 6.0); }

vec2 envmap_row(vec3 place) { return vec2((place.z + place.x) / 6.0, place.y); }

vec2 envmap_3x2(vec3 place) {
  float row = place.z < 2.5 ? 0.0 : 1.0;
  return vec2((place.z - 3.0 * row + place.x) / 3.0, 0.5 * (row + place.y));
}

// Columns and rows of both crosses, but for the +Z face of the vertical one.
vec2 envmap_cross_slot(float face) {
  if (face > 4.5) return vec2(1.0, 1.0);
  if (face > 3.5) return vec2(3.0, 1.0);
  if (face > 1.5) return vec2(1.0, face < 2.5 ? 0.0 : 2.0);
  return vec2(face < 0.5 ? 2.0 : 0.0, 1.0);
}

vec2 envmap_cross(vec3 place) {
  vec2 at = envmap_cross_slot(place.z) + place.xy;
  return vec2(at.x / 4.0, at.y / 3.0);
}

// The +Z face hangs below -Y and stands on its head.
vec2 envmap_vcross(vec3 place) {
  vec2 at = envmap_cross_slot(place.z) + place.xy;
  if (place.z > 3.5 && place.z < 4.5) at = vec2(2.0 - place.x, 4.0 - place.y);
  return vec2(at.x / 3.0, at.y / 4.0);
}

// ---- Parallax: the direction in which a map shows what a ray meets --------------------------------------------------
//
// p is where the ray begins, measured from the centre of the map, and r its direction, both in the axes of the map.

// In a box-shaped room between the corners low and high, measured from the centre of the map. p lies inside
// (Lagarde and Zanuttini 2012).
vec3 envmap_box(vec3 p, vec3 r, vec3 low, vec3 high) {
  vec3 wall = vec3(r.x < 0.0 ? low.x : high.x, r.y < 0.0 ? low.y : high.y, r.z < 0.0 ? low.z : high.z);
  vec3 t = abs(wall - p) / max(abs(r), vec3(1e-20, 1e-20, 1e-20));
  return normalize(p + min(t.x, min(t.y, t.z)) * r);
}

// In any surroundings. `nearness` has 1 / distance in its red channel, 0 where nothing is, and linear filtering.
// Two commands make it (.dds for HLSL):
//   envmap render room.glb room.exr --distance
//   envmap convert room.exr nearness.ktx2 --channels 1/Z --to cube
// The point (1 - s) p + s |p| r, up to a factor, runs along the ray for s from 0 to 1. It meets a surface where `excess`
// is 0, which is linear in s along a plane (Szirmay-Kalos et al. 2005).
// In a box-shaped room, eight halvings and a secant are right to 0.1 degrees for 99% of rays and to 1 degree for all.
vec3 envmap_parallax(samplerCube nearness, vec3 p, vec3 r) {
  float most = max(length(p), 1e-6);
  float low = 0.0, high = 1.0;
  float below = most * textureLod(nearness, p + 1e-6 * r, 0.0).x - 1.0;
  float above = most * textureLod(nearness, r, 0.0).x;
  for (int k = 0; k < 8; ++k) {
    float s = 0.5 * (low + high);
    vec3 x = (1.0 - s) * p + (s * most) * r;
    float excess = length(x) * textureLod(nearness, x, 0.0).x - (1.0 - s);
    if (excess < 0.0) {
      low = s;
      below = excess;
    } else {
      high = s;
      above = excess;
    }
  }
  float met = low + (high - low) * below / min(below - above, -1e-20);
  return normalize((1.0 - met) * p + (met * most) * r);
}

// ---- Light ----------------------------------------------------------------------------------------------------------

// Levels of the prefiltered cube `specular` of 'envmap bake'. Level k has the perceptual roughness
// 1 - sqrt(1 - k / (ENVMAP_LEVELS - 1)): 0, 0.106, 0.225, 0.368, 0.553 and 1. alpha = roughness^2.
#define ENVMAP_LEVELS 6.0

float envmap_level(float roughness) { return (ENVMAP_LEVELS - 1.0) * roughness * (2.0 - roughness); }

// Radiance from the direction d through the GGX lobe of a roughness. `specular` has trilinear filtering.
vec3 envmap_prefiltered(samplerCube specular, vec3 d, float roughness) {
  return textureLod(specular, d, envmap_level(roughness)).rgb;
}

// Scale and bias of the split sum (Karis 2013). `brdf` is the table brdf.exr, with linear filtering and clamped edges.
// n_v is the cosine of the angle between normal and view. Off by 0.001, and near roughness 1 by 0.005.
vec2 envmap_scale_bias(sampler2D brdf, float n_v, float roughness) {
  return textureLod(brdf, vec2(n_v, roughness), 0.0).xy;
}

// Where to look up what a rough surface reflects: the direction, of any length, and the roughness of the level. A level is
// made for a view along the normal. Seen at an angle, metals reflect from between the mirrored direction and the normal,
// and all lobes are narrower across the plane of view. `edge` is the part of the reflection that Fresnel's term adds at
// grazing angles. Fitted to suns of 1 to 20 degrees: docs/explanation/rough-reflections.md.
vec4 envmap_lobe(vec3 n, vec3 v, float roughness, float edge) {
  float alpha = roughness * roughness;
  float leaning = alpha * (1.0 - edge);
  float narrower = (1.0 - max(dot(n, v), 0.0)) * (0.3 * (1.0 - alpha) + alpha * edge);
  float t = 1.0 - leaning * leaning;
  return vec4(t * reflect(-v, n) + (1.0 - t) * n, min(1.0, roughness * (1.0 + 0.16 * alpha) * (1.0 - narrower)));
}

// Radiance that a surface reflects towards v, the unit vector to the eye. n is the normal, and f0 the reflectance at
// normal incidence: 0.04 for most dielectrics, the base colour for metals.
vec3 envmap_specular(samplerCube specular, sampler2D brdf,
                     vec3 n, vec3 v, float roughness, vec3 f0) {
  vec2 scale_bias = textureLod(brdf, vec2(max(dot(n, v), 0.0), roughness), 0.0).xy;
  float whole = (f0.x + f0.y + f0.z) / 3.0 * scale_bias.x + scale_bias.y;
  vec4 lobe = envmap_lobe(n, v, roughness, scale_bias.y / max(whole, 1e-6));
  vec3 radiance = textureLod(specular, lobe.xyz, envmap_level(lobe.w)).rgb;
  return radiance * (f0 * scale_bias.x + vec3(scale_bias.y, scale_bias.y, scale_bias.y));
}

// Irradiance over pi of a surface with the normal n, which is the radiance of a white diffuse surface. c holds the nine
// colours of irradiance.txt, in order.
vec3 envmap_irradiance(vec3 c[9], vec3 n) {
  vec3 degree1 = c[1] * n.y + c[2] * n.z + c[3] * n.x;
  vec3 degree2 = c[4] * (n.x * n.y) + c[5] * (n.y * n.z) + c[6] * (3.0 * n.z * n.z - 1.0) + c[7] * (n.z * n.x) +
                 c[8] * (n.x * n.x - n.y * n.y);
  return max(c[0] + degree1 + degree2, vec3(0.0, 0.0, 0.0));
}

#endif
