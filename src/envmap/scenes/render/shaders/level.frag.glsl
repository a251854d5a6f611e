// A level of a mirror's map from the one above it: the mean, by solid angle, of what each texel covers, two by two texels or,
// of odd sizes, parts of three. solid_angle() is that of mirror_*.glsl; 0 where a texel is no part of the map.
layout(location = 0) out vec4 colour;
layout(binding = UNIT_MIRROR) uniform sampler2DArray finer;
uniform int layer;
uniform bool surfaces;  // Only: coverage takes the place of nearness, and the environment's texels are empty.

void main() {
  ivec2 size = textureSize(finer, 0).xy;
  vec2 scale = vec2(size) / max(size / 2, 1), low = scale * floor(gl_FragCoord.xy), high = low + scale;
  vec4 sum = vec4(0);
  float weights = 0;
  for (int j = int(low.y); j < min(high.y, size.y); ++j)
    for (int i = int(low.x); i < min(high.x, size.x); ++i) {
      vec2 part = min(high, vec2(i, j) + 1) - max(low, vec2(i, j));
      float weight = part.x * part.y * solid_angle(2 * (vec2(i, j) + 0.5) / size - 1, 2.0 / size.x);
      vec4 texel = texelFetch(finer, ivec3(i, j, layer), 0);
      if (surfaces) texel = texel.a > 0 ? vec4(texel.rgb, 1) : vec4(0);
      sum += weight * texel;
      weights += weight;
    }
  colour = weights > 0 ? sum / weights : vec4(0);
}
