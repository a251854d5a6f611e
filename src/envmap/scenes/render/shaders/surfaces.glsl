// What a mirror's map shows at a place. With lookup by distance these are the surfaces alone, and how much of the place they
// cover: nearness tells texels of the environment, which is sharper in its own texture, from all others.
vec4 shown_at(vec3 at, vec2 on_face, float level) {
#if BY_DISTANCE
  // Level 0 holds the environment, too. Others are of surfaces alone (level.frag.glsl).
  if (level >= 1) return textureLod(mirror, at, level);
  vec4 there = vec4(textureLod(mirror, at, 0).rgb, 1), covered = vec4(greaterThan(textureGather(mirror, at, 3), vec4(0)));
  if (covered != vec4(1)) {
    vec2 part = fract(on_face * textureSize(mirror, 0).xy - 0.5), rest = 1 - part;
    vec4 weights = covered * vec4(rest.x * part.y, part.x * part.y, part.x * rest.y, rest.x * rest.y);
    there = vec4(0);
    if (covered != vec4(0))
      there = vec4(dot(weights, textureGather(mirror, at, 0)), dot(weights, textureGather(mirror, at, 1)),
                   dot(weights, textureGather(mirror, at, 2)), dot(weights, vec4(1)));
  }
  return level > 0 ? mix(there, textureLod(mirror, at, 1), level) : there;
#else
  return vec4(textureLod(mirror, at, level).rgb, 1);
#endif
}
