// Where the map shows a point (Heidrich and Seidel 1998). Straight sides stay straight, which is wrong by the more the
// larger the triangle.
uniform float singularity;

vec4 distorted(vec3 p) {
#if SHAPE == PLANE
  return vec4(vec2(p.x, -p.y) + shift * p.z, 0.57 * range.x, p.z);
#elif SHAPE == DISC
  float distance = max(length(p), 1e-30), across = length(p.xy);
  vec2 outwards = across > 0 ? p.xy / across : vec2(1, 0);
  // The singularity has no place in the image: points that are nearer to it lie at infinity.
  if (p.z < (singularity - 1) * distance) return vec4(outwards.x, -outwards.y, 0, 0);
  vec2 at = radius(acos(p.z / distance)) * outwards;
  // Affine in 1 / distance, as the depth of a plain projection is in 1 / z.
  return vec4(vec2(at.x, -at.y) + shift, range.x / distance, 1);
#else
#error "vertices cannot be moved into images of this shape"
#endif
}
