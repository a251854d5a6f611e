// What is behind all surfaces. A ray of length 0 is outside the disc of the map: nothing.
layout(location = 0) out vec4 colour;  // Radiance, and 1 / distance.
uniform mat3 to_world;  // From the map.
uniform float weight;
uniform vec3 behind;    // Light from there beside the environment's.

// To the next texel of the map across or down. At a rim, from the one before.
vec3 change(ivec2 at, ivec2 step, vec3 ray) {
  ivec2 there = at + step;
  bool inside = all(lessThan(there, textureSize(rays, 0)));
  vec3 next = inside ? ray_at(there).along : vec3(0);
  if (next != vec3(0)) return next - ray;
  vec3 last = all(greaterThanEqual(at, step)) ? ray_at(at - step).along : vec3(0);
  return last != vec3(0) ? ray - last : vec3(0);
}

void main() {
  ivec2 at = ivec2(gl_FragCoord.xy);
  vec3 ray = ray_at(at).along;
  vec3 radiance = vec3(0);
  if (ray != vec3(0)) {
    vec3 across = change(at, ivec2(1, 0), ray), down = change(at, ivec2(0, 1), ray);
    // A mean would only blur if texels of the map are smaller than those of the environment.
    float part = max(length(across), length(down)) > environment_texel ? 1 : 0;
    radiance = behind + environment_over(to_world * ray, part * to_world * across, part * to_world * down);
  }
  colour = vec4(weight * radiance, 0);
}
