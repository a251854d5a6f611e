// Each texel once, whatever lay behind it: the surface that it sees, met by its own ray, lit. After Burns and Hunt 2013,
// "The visibility buffer".
layout(location = 0) out vec4 colour;  // Radiance, and the distance.
layout(binding = 0) uniform sampler2D rays;
layout(binding = 5) uniform usampler2D surfaces;
uniform mat3 to_world;  // From the map.
uniform float weight;
uniform float spread;   // Distance of samples, in texels.
uniform int group;

// How texture coordinates change from this ray to that of a neighbour. A neighbour that misses the plane is far off.
vec2 change(Triangle t, ivec2 at, ivec2 step, vec3 ray, vec2 here) {
  ivec2 size = textureSize(rays, 0), there = at + step;
  if (any(greaterThanEqual(there, size)) || texelFetch(rays, there, 0).xyz == vec3(0)) there = at - step;
  vec3 weights = weights_of(t, texelFetch(rays, max(there, 0), 0).xyz);
  float sum = weights.x + weights.y + weights.z;
  return sum > 0 ? spread * (coordinates_at(t, weights / sum) - here) : vec2(1e3);
}

void main() {
  ivec2 at = ivec2(gl_FragCoord.xy);
  uvec2 seen = texelFetch(surfaces, at, 0).xy;
  int number = int(seen.x) - 1;
  if (number < 0) discard;
  Material material = materials[instances[number].material];
  if (material.group != group) discard;
  vec3 ray = texelFetch(rays, at, 0).xyz;
  Triangle t = triangle_of(number, seen.y);
  vec3 volumes = weights_of(t, ray), weights = inside(volumes);
  vec3 position = mat3(t.a, t.b, t.c) * weights;
  bool hit = min(volumes.x, min(volumes.y, volumes.z)) >= 0;
  float distance = hit ? abs(t.height) / abs(dot(ray, t.normal)) : length(position);

  vec2 place = coordinates_at(t, weights);
  vec2 along = change(t, at, ivec2(1, 0), ray, place), down = change(t, at, ivec2(0, 1), ray, place);
  vec3 normal = mat3(instances[number].normals) * (mat3(three(t.at.x + 3), three(t.at.y + 3), three(t.at.z + 3)) * weights);
  vec3 flat_normal = to_world * t.normal * (t.height < 0 ? 1.0 : -1.0);
  if (dot(normal, normal) == 0) normal = flat_normal;
  // The side that is seen, of surfaces with two.
  if ((t.height < 0) != (instances[number].mirrored == 0)) normal = -normal;

  Surface surface;
  surface.position = to_world * position;
  surface.normal = normalize(normal);
  surface.base_colour = material.base_colour;
  if (material.base_colour_texture != 0) surface.base_colour *= textureGrad(base_colours, place, along, down);
  surface.metallic = material.metallic;
  surface.roughness = material.roughness;
  if (material.metallic_roughness_texture != 0) {
    vec2 both = textureGrad(metallic_roughnesses, place, along, down).bg;
    surface.metallic *= both.x;
    surface.roughness *= both.y;
  }
  surface.emissive = material.emissive.rgb;
  if (material.emissive_texture != 0) surface.emissive *= textureGrad(emissives, place, along, down).rgb;
  colour = vec4(weight * shade(surface, to_world * -ray), distance);
}
