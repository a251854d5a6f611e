// Adds one sample of all texels to the others.
layout(location = 0) out vec4 colour;  // Radiance, and 1 / distance.
layout(binding = UNIT_BEHIND) uniform sampler2D samples;
uniform float weight;

void main() {
  vec4 texel = texelFetch(samples, ivec2(gl_FragCoord.xy), 0);
  colour = vec4(weight * texel.rgb, texel.a);
}
