// The image of a light (render/light_image.h): x and y from -1 to 1, and how near things are: 1 / depth of a pinhole,
// -depth of parallel rays. Of a plane that is linear in x and y: three numbers hold it.
struct LightFace {
  vec4 right, up, ahead;  // World; w: of the centre, from the viewpoint.
  vec4 lens;              // Half the width; 1 for parallel rays, else 0; the depth that nothing may lie before.
};
layout(std430, binding = BUFFER_LIGHT_FACES) readonly buffer LightFaces { LightFace light_faces[]; };

bool is_parallel(LightFace f) { return f.lens.y != 0; }
vec3 to_light(LightFace f, vec3 v) { return vec3(dot(f.right.xyz, v), dot(f.up.xyz, v), dot(f.ahead.xyz, v)); }

// Of all points with dot(n, point) = h, n unit, in the axes of the face. Nearness is dot(plane, vec3(x, y, 1)).
vec3 plane_seen(LightFace f, vec3 n, float h) {
  return is_parallel(f) ? vec3(f.lens.x * n.xy, -h) / n.z : vec3(f.lens.x * n.xy, n.z) / h;
}

// How much nearness changes for each metre across a plane, times depth where there is one.
float slope(LightFace f, vec3 plane) { return length(vec3(plane.xy / f.lens.x, is_parallel(f) ? 1 : plane.z)); }
