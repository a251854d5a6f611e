// What a texel sees: the instance + 1, and which of its triangles. Depth is near / distance: 1 at the near sphere, falling
// to 0, so that floats hold it with the same relative error at any distance.
layout(location = 0) out uvec2 surface;
