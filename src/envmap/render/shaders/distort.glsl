// A vertex moved to where the map shows it (Heidrich and Seidel 1998); straight sides stay straight, which is wrong by
// the more the larger the triangle. Points nearer to the singularity than `singularity` (z < -1 + singularity) are
// pushed away from it.
uniform float singularity;

vec4 distorted(vec3 p) {
#if SHAPE == PLANE
  return vec4(vec2(p.x, -p.y) + shift * p.z, 0.57 * range.x, p.z);
#elif SHAPE == DISC
  float distance = max(length(p), 1e-30);
  vec3 d = p / distance;
  float z = max(d.z, singularity - 1), across = length(d.xy);
  vec2 outwards = across > 0 ? d.xy / across : vec2(1, 0);
  vec2 at = radius(acos(z)) * outwards;
  // Affine in 1 / distance, as the depth of a plain projection is in 1 / z.
  return vec4(vec2(at.x, -at.y) + shift, range.x / distance, 1);
#else
#error "vertices cannot be moved into images of this shape"
#endif
}
