// What a texel sees: the instance + 1, and which of its triangles. Depth is near / distance: 1 at the near sphere, falling
// to 0, so that floats hold it with the same relative error at any distance.
layout(location = 0) out uvec2 surface;

#if LAYERED
// Of blended surfaces the furthest are found first (GL_LESS), and of each texel what was found is left out. Everitt 2001,
// "Interactive order-independent transparency".
layout(binding = UNIT_BEHIND) uniform sampler2D behind;

bool is_done(float depth) { return depth <= texelFetch(behind, ivec2(gl_FragCoord.xy), 0).r; }
#endif
