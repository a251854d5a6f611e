// Each texel once, whatever lay behind it: the surface that it sees, met by its own ray, lit. After Burns and Hunt 2013,
// "The visibility buffer". The stencil chooses the texels of one group of materials; TEXTURES are the ones they have
// (Group::textures): 1 base colour, 2 metallic and roughness, 4 emissive, 8 normal, 16 occlusion; of the coat 32 how much,
// 64 roughness, 128 normal; of sheen 256 colour, 512 roughness.
layout(early_fragment_tests) in;
layout(location = 0) out vec4 colour;  // Radiance, and 1 / distance; of blended surfaces the part that they cover.
layout(binding = UNIT_SURFACES) uniform usampler2D surfaces;
uniform mat3 to_world;  // From the map.
uniform float weight;
uniform int blended;

// How texture coordinates change from this ray to that of a neighbour. A neighbour that misses the plane is far off.
vec2 change(Triangle t, Ray ray, ivec2 at, ivec2 step, vec2 here) {
  ivec2 size = textureSize(rays, 0), there = at + step;
  Ray next = ray_at(min(there, size - 1));
  if (any(greaterThanEqual(there, size)) || next.along == vec3(0)) next = ray_at(max(at - step, 0));
  vec3 weights = weights_of(t, next.along), aside = next.from - ray.from;
  if (aside != vec3(0))
    weights = weights_at(t, aside + (t.height - dot(t.normal, aside)) / dot(t.normal, next.along) * next.along);
  float sum = weights.x + weights.y + weights.z;
  return sum > 0 ? spread * (t.places * weights / sum - here) : vec2(1e3);
}

#if HAS_FOOTPRINT
// The same of the surface itself, in the world. A ball ends at its outline: of the neighbours on both sides the one counts
// where the normal changes less.
Beside next_to(Triangle t, mat3 turn, ivec2 at, ivec2 step) {
  ivec2 size = textureSize(rays, 0);
  Ray whole = ray_at(at);
  Beside best = Beside(here.position, vec3(0), here.ray);
  float least = 1e9;
  for (int way = -1; way <= 1; way += 2) {
    ivec2 there = at + way * step;
    if (any(lessThan(there, ivec2(0))) || any(greaterThanEqual(there, size))) continue;
    Ray next = ray_at(there);
    vec3 aside = next.from - whole.from;
    float far_off = (t.height - dot(t.normal, aside)) / dot(t.normal, next.along);
    vec3 place = aside + far_off * next.along, weights = weights_at(t, place);
    float sum = weights.x + weights.y + weights.z;
    if (next.along == vec3(0) || !(far_off > 0) || !(sum > 0)) continue;
    vec3 normal = t.normals * (weights / sum) * turn;
    normal = (dot(normal, normal) > 0 ? normalize(normal) : here.normal) - here.normal;
    if (dot(normal, normal) >= least) continue;
    least = dot(normal, normal);
    best.position = here.position + way * spread * (to_world * (whole.from + place) - here.position);
    best.normal = way * spread * normal;
    best.ray = normalize(here.ray + way * spread * (to_world * next.along - here.ray));
  }
  return best;
}
#endif

// From a place on a triangle to the mean of where the planes of its corners have it: ShadingPoint::lifted of shading.h.
// @param turn to the world's normals, on the side that is seen.
vec3 lift(Triangle t, vec3 place, vec3 weights, mat3 turn) {
  vec3 sum = vec3(0);
  for (int k = 0; k < 3; ++k) {
    vec3 corner = k == 0 ? t.a : k == 1 ? t.b : t.c, n = t.normals[k] * turn;
    if (dot(n, n) > 0) sum -= weights[k] * min(0, dot(to_world * (place - corner), normalize(n))) * normalize(n);
  }
  return sum;
}

#if (TEXTURES & 136) != 0
// What a map makes of the normal of the front (glTF 2.0, 3.9.3). @param handed -1: mirrored.
vec3 mapped_normal(vec3 normal, vec4 tangent, float handed, float scale, vec3 texel) {
  vec3 along = dot(tangent.xyz, tangent.xyz) > 0 ? normalize(tangent.xyz) : vec3(0);
  vec3 across = cross(normal, along) * (tangent.w < 0 ? -handed : handed);
  texel = 2 * texel - 1;
  vec3 n = scale * (texel.x * along + texel.y * across) + texel.z * normal;
  return dot(n, n) > 0 ? normalize(n) : normal;
}
#endif

void main() {
  ivec2 at = ivec2(gl_FragCoord.xy);
  uvec2 seen = texelFetch(surfaces, at, 0).xy;
  int number = int(seen.x) - 1;
  Ray whole = ray_at(at);
  vec3 ray = whole.along;
  Triangle t = triangle_of(number, seen.y, whole.from);
  vec3 volumes = weights_of(t, ray), weights = inside(volumes);
  bool hit = min(volumes.x, min(volumes.y, volumes.z)) >= 0;
  float far_off = hit ? t.height / dot(ray, t.normal) : length(mat3(t.a, t.b, t.c) * weights);

  // The last of the rows holds what else there is: the material, and -1 for the side that is seen of mirrored meshes.
  vec4 x = texelFetch(instances, 6 * number + 3), y = texelFetch(instances, 6 * number + 4),
       z = texelFetch(instances, 6 * number + 5);
  vec3 normal = t.normals * weights * mat3(x.xyz, y.xyz, z.xyz);
  if (dot(normal, normal) == 0) normal = to_world * t.normal * y.w;
  // Of surfaces with two sides, the one that is seen.
  float side = t.height * y.w > 0 ? -1 : 1;
  normal *= side;

  int material = MATERIAL * int(x.w);
  vec4 glow = texelFetch(materials, material + 1), rest = texelFetch(materials, material + 2);
  ShadingPoint surface;
  surface.position = to_world * (whole.from + far_off * ray);
  surface.normal = surface.smooth_normal = normalize(normal);
  surface.base_colour = texelFetch(materials, material) * colour_of(seen.y, weights);
  surface.metallic = rest.x;
  surface.roughness = rest.y;
  surface.emissive = glow.rgb;
  surface.transmission = rest.z;
  surface.ior = rest.w;
  vec3 more = texelFetch(materials, material + 3).xyz;
  surface.bend = more.x;
  vec4 row0 = texelFetch(instances, 6 * number), row1 = texelFetch(instances, 6 * number + 1),
       row2 = texelFetch(instances, 6 * number + 2);
  float scale = pow(abs(determinant(mat3(row0.xyz, row1.xyz, row2.xyz))), 1.0 / 3);
  surface.volume = texelFetch(materials, material + 6) * vec4(1, 1, 1, scale);
  surface.reached = 1;
  surface.shadow_origin = surface.position + lift(t, far_off * ray, weights, side * mat3(x.xyz, y.xyz, z.xyz));
#if TEXTURES != 0
  vec2 place = t.places * weights;
  vec2 along = change(t, whole, at, ivec2(1, 0), place), down = change(t, whole, at, ivec2(0, 1), place);
#endif
#if (TEXTURES & 1) != 0
  surface.base_colour *= textureGrad(base_colours, place, along, down);
#endif
#if (TEXTURES & 2) != 0
  vec2 both = textureGrad(metallic_roughnesses, place, along, down).bg;
  surface.metallic *= both.x;
  surface.roughness *= both.y;
#endif
#if (TEXTURES & 4) != 0
  surface.emissive *= textureGrad(emissives, place, along, down).rgb;
#endif
#if (TEXTURES & 136) != 0
  vec4 tangent = tangent_of(number, seen.y, weights);
  tangent.xyz = to_world * tangent.xyz;
#endif
#if (TEXTURES & 8) != 0
  surface.normal = side * mapped_normal(side * surface.normal, tangent, y.w, more.y,
                                        textureGrad(normal_maps, place, along, down).xyz);
#endif
#if (TEXTURES & 16) != 0
  surface.reached += more.z * (textureGrad(occlusions, place, along, down).r - 1);
#endif
#if SHEEN
  vec4 sheen = texelFetch(materials, material + 4);
  surface.sheen = sheen.rgb;
  surface.sheen_roughness = sheen.a;
#endif
#if (TEXTURES & 256) != 0
  surface.sheen *= textureGrad(sheens, place, along, down).rgb;
#endif
#if (TEXTURES & 512) != 0
  surface.sheen_roughness *= textureGrad(sheen_roughnesses, place, along, down).a;
#endif
#if COATED
  vec4 coat = texelFetch(materials, material + 5);
  surface.coat = coat.x;
  surface.coat_roughness = coat.y;
  surface.coat_normal = surface.smooth_normal;
#endif
#if (TEXTURES & 32) != 0
  surface.coat *= textureGrad(coats, place, along, down).r;
#endif
#if (TEXTURES & 64) != 0
  surface.coat_roughness *= textureGrad(coat_roughnesses, place, along, down).g;
#endif
#if (TEXTURES & 128) != 0
  surface.coat_normal = side * mapped_normal(side * surface.smooth_normal, tangent, y.w, coat.z,
                                             textureGrad(coat_normal_maps, place, along, down).xyz);
#endif
#if HAS_FOOTPRINT
  here = Beside(surface.position, surface.smooth_normal, to_world * ray);
  mat3 turn = side * mat3(x.xyz, y.xyz, z.xyz);
  beside[0] = next_to(t, turn, at, ivec2(1, 0));
  beside[1] = next_to(t, turn, at, ivec2(0, 1));
#endif
#if BY_VERTEX
  // The classic way: reflected directions at the corners, places in the map between them, all in the first one's face.
  place_by_vertex = vec3(0);
  reflects_only = surface.transmission == 0;
  bool is_parallel = whole.from != vec3(0);
  float face = 0;
  for (int k = 0; k < 3; ++k) {
    vec3 corner = k == 0 ? t.a : k == 1 ? t.b : t.c, n = normalize(t.normals[k] * mat3(x.xyz, y.xyz, z.xyz));
    vec3 place = place_of(to_mirror * reflect(normalize(to_world * (is_parallel ? ray : corner)), n));
    if (k == 0) face = place.z;
    place_by_vertex += weights[k] * place;
  }
  place_by_vertex = in_face(place_by_vertex, face);
#endif
  // A statement of its own: it sets `beyond`, and nobody says in which order the parts of an expression are found.
  vec3 light = shade(surface, to_world * -ray);
  colour = vec4(weight * light, blended != 0 ? clamp(surface.base_colour.a, 0, 1) : 1 / (far_off + beyond));
}
