// The mean of a mirror's map over what a pixel shows of it: an ellipse that two changes of direction span, by lookups along
// its longer axis in a level whose texels are as wide as the shorter one. Source: McCormack, Perry, Farkas and Jouppi 1999,
// "Feline: fast elliptical lines for anisotropic texture mapping".
const int most_lookups = 8;
const float finer = 0.5;  // Of a level: there the tent of bilinear filtering varies as much as the pixel's box.

// @param d unit. @param across, down how it changes from this pixel to the next.
vec4 mirror_over(vec3 d, vec3 across, vec3 down) {
  float a = dot(across, across), b = dot(across, down), c = dot(down, down);
  float root = sqrt(0.25 * (a - c) * (a - c) + b * b), longer = sqrt(0.5 * (a + c) + root);
  vec2 along = a >= c ? vec2(0.5 * (a - c) + root, b) : vec2(b, 0.5 * (c - a) + root);
  vec3 axis = along.x * across + along.y * down;
  axis *= longer / max(length(axis), 1e-20);
  float size = 2.0 / textureSize(mirror, 0).x, shorter = sqrt(max(0, a * c - b * b)) / max(longer, 1e-20);
  shorter = max(shorter, max(longer / most_lookups, texel_angle(d, size)));
  int lookups = clamp(int(ceil(longer / shorter)), 1, most_lookups), coarsest = textureQueryLevels(mirror) - 1;
  vec4 sum = vec4(0);
  for (int k = 0; k < lookups; ++k) {
    vec3 there = normalize(d + ((k + 0.5) / lookups - 0.5) * axis);
    sum += mirror_at(there, clamp(log2(shorter / texel_angle(there, size)) - finer, 0, coarsest));
  }
  return sum / lookups;
}
