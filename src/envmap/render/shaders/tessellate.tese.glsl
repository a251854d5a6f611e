layout(triangles, equal_spacing, ccw) in;
in vec3 corner[];
patch in uint patch_number;
flat out uint triangle;

void main() {
  triangle = patch_number;
  gl_Position = distorted(
      to_face * (gl_TessCoord.x * corner[0] + gl_TessCoord.y * corner[1] + gl_TessCoord.z * corner[2]));
}
