// Corners of patches without indices: gl_PrimitiveID of patches starts again in the midst of large draws (Mesa 22.3).
out vec3 placed;
flat out uint number;

void main() {
  placed = (to_map * vec4(texelFetch(corners, CORNER * gl_VertexID).xyz, 1)).xyz;
  number = uint(gl_VertexID / 3);
}
