// What is behind all surfaces. A ray of length 0 is outside the disc of the map: nothing.
layout(location = 0) out vec4 colour;  // Radiance, and 1 / distance.
uniform mat3 to_world;  // From the map.
uniform float weight;
uniform vec3 behind;    // Light from there beside the environment's.
uniform float environment_texel;  // Radians.
const float samples_a_texel = 3;  // Of the environment.
const int most_samples = 8;       // Each way.

// To the next texel of the map across or down. At a rim, from the one before.
vec3 change(ivec2 at, ivec2 step, vec3 ray) {
  ivec2 there = at + step;
  bool inside = all(lessThan(there, textureSize(rays, 0)));
  vec3 next = inside ? ray_at(there).along : vec3(0);
  if (next != vec3(0)) return next - ray;
  vec3 last = all(greaterThanEqual(at, step)) ? ray_at(at - step).along : vec3(0);
  return last != vec3(0) ? ray - last : vec3(0);
}

// One sample where texels of the map are the smaller ones: their mean would only blur.
vec3 mean_over(ivec2 at, vec3 ray) {
  vec3 across = change(at, ivec2(1, 0), ray), down = change(at, ivec2(0, 1), ray);
  float ratio = max(length(across), length(down)) / environment_texel;
  int n = ratio <= 1 ? 1 : clamp(int(ceil(samples_a_texel * ratio)), 1, most_samples);
  vec3 sum = vec3(0);
  for (int k = 0; k < n * n; ++k) {
    vec2 aside = (vec2(k % n, k / n) + 0.5) / n - 0.5;
    sum += environment_at(to_world * normalize(ray + aside.x * across + aside.y * down));
  }
  return sum / (n * n);
}

void main() {
  ivec2 at = ivec2(gl_FragCoord.xy);
  vec3 ray = ray_at(at).along;
  vec3 radiance = ray == vec3(0) ? vec3(0) : behind + mean_over(at, ray);
  colour = vec4(weight * radiance, 0);
}
