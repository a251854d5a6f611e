// As many pieces as bring each side within `tolerance` pixels of its curve: cut in n, the distance of a chord from the
// curve shrinks with n^2. Both triangles of a side find the same number.
layout(vertices = 3) out;
in vec3 placed[];
flat in uint number[];
out vec3 corner[];
patch out uint patch_number;
uniform float tolerance;

// Of what lies at infinity: where the image ends.
vec4 bounded(vec3 p) {
  vec4 at = distorted(to_face * p);
  return at.w > 0 ? at : vec4(radius(acos(singularity - 1)) * at.xy, 0, 1);
}

float pieces(vec3 a, vec3 b) {
  vec4 from = bounded(a), to = bounded(b);
  float most = 0;
  for (int k = 1; k < 4; ++k) {
    // At equal angles rather than distances: a point near the viewpoint is most of the way.
    vec4 at = bounded(mix(a, b, 0.25 * k));
    vec2 chord = to.xy - from.xy, off = at.xy - from.xy;
    float along = dot(chord, chord) > 0 ? clamp(dot(off, chord) / dot(chord, chord), 0, 1) : 0;
    most = max(most, length((off - along * chord) / pixel));
  }
  // Depth bends too, by as much as the distance does.
  float bend = abs(from.z + to.z - 2 * bounded(0.5 * (a + b)).z) / max(from.z + to.z, 1e-30);
  return clamp(sqrt(most / tolerance) + 8 * bend, 1, 64);
}

void main() {
  corner[gl_InvocationID] = placed[gl_InvocationID];
  if (gl_InvocationID != 0) return;
  patch_number = number[0];
  float bc = pieces(placed[1], placed[2]), ca = pieces(placed[2], placed[0]), ab = pieces(placed[0], placed[1]);
  gl_TessLevelOuter[0] = bc;
  gl_TessLevelOuter[1] = ca;
  gl_TessLevelOuter[2] = ab;
  gl_TessLevelInner[0] = max(bc, max(ca, ab));
}
