// The part of the image that a triangle can be seen in: a rectangle that surely holds its curved outline, from the
// range of its two angles, which is known in closed form; no vertex need be near another.
struct Rectangle {
  vec2 centre, along, across;  // Half sides as vectors, y up.
};
const Rectangle nothing = Rectangle(vec2(0), vec2(0), vec2(0));
// The compiler's own arctangents and our rounding; in radians. Snapping of corners by the rasteriser; in pixels.
const float angle_slack = 5e-5, pixel_slack = 0.02;

#if SHAPE != PLANE
struct Angles {
  vec2 from_axis, round_it;  // Least and largest. round_it spans 2 PI where the axis lies inside.
};

float from_axis(vec3 p) { return atan(length(p.xy), p.z); }

// The point of the great circle from a to b that is nearest to the axis, or furthest from it, lies between a and b
// where the arc rises at one end and falls at the other. Normal n = a x b.
void extend_by_arc(vec3 a, vec3 b, vec3 n, inout vec2 range) {
  float rise = n.x * a.y - n.y * a.x, fall = b.x * n.y - b.y * n.x;
  float nearest = atan(abs(n.z), length(n.xy));
  if (rise >= 0 && fall >= 0) range.x = min(range.x, nearest);
  if (rise <= 0 && fall <= 0) range.y = max(range.y, PI - nearest);
}

float turn(float from, float to) {
  float by = to - from;
  return by - 2 * PI * round(by / (2 * PI));
}

// n: the planes through the origin and the sides ab, bc, ca.
Angles angles_of(vec3 a, vec3 b, vec3 c, mat3 n, float volume) {
  vec3 at = vec3(from_axis(a), from_axis(b), from_axis(c));
  vec2 range = vec2(min(at.x, min(at.y, at.z)), max(at.x, max(at.y, at.z)));
  extend_by_arc(a, b, n[0], range);
  extend_by_arc(b, c, n[1], range);
  extend_by_arc(c, a, n[2], range);
  // +Z or -Z inside: on the same side of all three planes. Which of the two, the volume says, unless rounding decides it.
  vec3 height = vec3(n[0].z, n[1].z, n[2].z) * sign(volume);
  vec3 slack = 4e-7 * vec3(length(n[0]), length(n[1]), length(n[2]));
  bool front = all(greaterThanEqual(height, -slack)), back = all(lessThanEqual(height, slack));
  if (front) range.x = 0;
  if (back) range.y = PI;
  range += vec2(-angle_slack, angle_slack);
  float first = atan(a.y, a.x), to_b = turn(first, atan(b.y, b.x)), to_c = turn(first, atan(c.y, c.x));
  vec2 round_it = first + vec2(min(0, min(to_b, to_c)) - angle_slack, max(0, max(to_b, to_c)) + angle_slack);
  if (front || back || max(abs(to_b), max(abs(to_c), abs(to_c - to_b))) > PI - 0.01) round_it = vec2(-PI, PI);
  return Angles(vec2(max(range.x, 0), min(range.y, PI)), round_it);
}
#endif

#if SHAPE == BAND
// Two of them where the triangle lies across the seam.
Rectangle rectangle_of(Angles angles, float shift) {
  vec2 x = -(angles.round_it + shift) / PI, y = 1 - 2 * angles.from_axis / PI;
  return Rectangle(0.5 * vec2(x.x + x.y, y.x + y.y), vec2(0.5 * abs(x.x - x.y) + pixel_slack * pixel.x, 0),
                   vec2(0, 0.5 * abs(y.x - y.y) + pixel_slack * pixel.y));
}
#elif SHAPE == DISC
Rectangle rectangle_of(Angles angles) {
  if (angles.from_axis.x > REACH) return nothing;
#if FILLED
  float slack = pixel_slack * pixel.x;
#else
  // Texels on the rim look up to two pixels further inside than they lie.
  float slack = (radius(angles.from_axis.y) > 1 - 4 * pixel.x ? 2 : pixel_slack) * pixel.x;
#endif
  vec2 r = vec2(radius(angles.from_axis.x), radius(angles.from_axis.y));
  float half_turn = 0.5 * (angles.round_it.y - angles.round_it.x), middle = angles.round_it.x + half_turn;
  if (half_turn >= 0.5 * PI) return Rectangle(vec2(0), vec2(r.y + slack, 0), vec2(0, r.y + slack));
  r.x *= cos(half_turn);
  vec2 outwards = vec2(cos(middle), sin(middle));
  return Rectangle(0.5 * (r.x + r.y) * outwards, (0.5 * (r.y - r.x) + slack) * outwards,
                   (r.y * sin(half_turn) + slack) * vec2(-outwards.y, outwards.x));
}
#else
// Only what lies in front of a plane parallel to the face, as near as the near sphere reaches into the square, counts.
void extend_by_corner(vec3 p, inout vec2 low, inout vec2 high) {
  low = min(low, p.xy / p.z);
  high = max(high, p.xy / p.z);
}
void extend_by_side(vec3 a, vec3 b, float plane, inout vec2 low, inout vec2 high) {
  if (a.z >= plane) extend_by_corner(a, low, high);
  if ((a.z >= plane) != (b.z >= plane)) {
    vec2 meets = mix(a.xy, b.xy, clamp((plane - a.z) / (b.z - a.z), 0, 1));
    extend_by_corner(vec3(meets, plane), low, high);
  }
}

Rectangle rectangle_of(vec3 a, vec3 b, vec3 c, float near) {
  vec3 x = vec3(a.x, b.x, c.x), y = vec3(a.y, b.y, c.y), z = vec3(a.z, b.z, c.z);
  if (all(lessThanEqual(z, vec3(0))) || all(greaterThan(x, z)) || all(greaterThan(-x, z)) || all(greaterThan(y, z)) ||
      all(greaterThan(-y, z)))
    return nothing;
  float plane = 0.577 * near, size = max(length(a), max(length(b), length(c)));
  bool crosses = any(lessThan(z, vec3(plane)));
  // Where the cut is too far from exact for that, the whole face.
  if (crosses && plane < 1e-5 * size) return Rectangle(vec2(0), vec2(1 + pixel.x, 0), vec2(0, 1 + pixel.y));
  vec2 low = vec2(1e30), high = vec2(-1e30);
  extend_by_side(a, b, plane, low, high);
  extend_by_side(b, c, plane, low, high);
  extend_by_side(c, a, plane, low, high);
  vec2 slack = pixel_slack * pixel + (crosses ? 1e-6 * size / plane : 0);
  low = max(low - slack, -1 - pixel);
  high = min(high + slack, 1 + pixel);
  if (any(lessThanEqual(high, low))) return nothing;
  return Rectangle(0.5 * (low + high), vec2(0.5 * (high.x - low.x), 0), vec2(0, 0.5 * (high.y - low.y)));
}
#endif
