// The pieces, in the frame of the map.
layout(triangles, equal_spacing, ccw) in;
in vec3 corner[];
patch in uint patch_number;
out vec3 placed;
flat out uint number;

void main() {
  placed = gl_TessCoord.x * corner[0] + gl_TessCoord.y * corner[1] + gl_TessCoord.z * corner[2];
  number = patch_number;
}
