// The image of a light (render/shadow_view.h): x and y from -1 to 1, and how near things are: 1 / depth of a pinhole,
// -depth of parallel rays. Of a plane that is linear in x and y: three numbers hold it.
struct ShadowView {
  vec4 right, up, ahead;  // World; w: of the centre, from the viewpoint.
  vec4 lens;              // Half the width; 1 for parallel rays, else 0; the depth that nothing may lie before.
};

bool is_parallel(ShadowView f) { return f.lens.y != 0; }
vec3 to_light(ShadowView f, vec3 v) { return vec3(dot(f.right.xyz, v), dot(f.up.xyz, v), dot(f.ahead.xyz, v)); }

// Of all points with dot(n, point) = h, n unit, in the axes of the face. Nearness is dot(plane, vec3(x, y, 1)).
vec3 plane_seen(ShadowView f, vec3 n, float h) {
  return is_parallel(f) ? vec3(f.lens.x * n.xy, -h) / n.z : vec3(f.lens.x * n.xy, n.z) / h;
}

// How much nearness changes for each metre across a plane, times depth where there is one.
float slope(ShadowView f, vec3 plane) { return length(vec3(plane.xy / f.lens.x, is_parallel(f) ? 1 : plane.z)); }

// A place as a light sees it.
struct Seen {
  vec3 at;         // In the image; z: 1.
  float depth;     // 1 of parallel rays.
  float nearness;
  vec3 plane;      // Of the surface.
  float slope;     // Of that plane.
  float rounding;  // Metres.
};

// @param place from the viewpoint, world axes. @param normal unit.
Seen seen_by(ShadowView f, vec3 place, vec3 normal) {
  vec3 p = to_light(f, place - vec3(f.right.w, f.up.w, f.ahead.w)), n = to_light(f, normal);
  Seen s;
  s.depth = is_parallel(f) ? 1 : p.z;
  s.nearness = is_parallel(f) ? -p.z : 1 / p.z;
  s.at = vec3(p.xy / (f.lens.x * s.depth), 1);
  s.plane = plane_seen(f, n, dot(n, p));
  s.slope = slope(f, s.plane);
  s.rounding = (length(place) + length(p)) / 131072;
  return s;
}

// Whether what a texel of a shadow map holds, the plane that its light sees there first, keeps the light from a place: the
// plane lies before it at its own place, and before the surface's plane at the texel's centre. So nothing is compared but
// what is known exactly, and there is no bias but what floats are rounded by. The first spares what is concave, the second
// what is convex (Dou, Yan, Kerzner, Dai and Wyman 2014, "Adaptive depth bias for shadow maps").
bool is_behind(Seen s, ShadowView f, vec3 plane, vec3 centre) {
  float nearness = dot(plane, centre), depth = is_parallel(f) ? 1 : 1 / nearness;
  return s.depth * (dot(plane, s.at) - s.nearness) > s.rounding * slope(f, plane) &&
         depth * (nearness - dot(s.plane, centre)) > s.rounding * s.slope;
}
