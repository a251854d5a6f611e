// What a flat mirror reflects of a picture: what the mirrored eye sees there, right and left exchanged.
const float beyond = 0, way = 1e30;  // Of reflect_mirror.glsl.
layout(binding = UNIT_MIRROR) uniform sampler2DArray mirrored;

vec3 reflected(vec3 from, vec3 normal, float bend) {
  ivec2 at = ivec2(gl_FragCoord.xy);
  return texelFetch(mirrored, ivec3(textureSize(mirrored, 0).x - 1 - at.x, at.y, 0), 0).rgb;
}
