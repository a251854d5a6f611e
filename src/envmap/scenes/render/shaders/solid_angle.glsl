// Solid angles of triangles (Van Oosterom and Strackee 1983).
float whole_solid_angle(vec3 a, vec3 b, vec3 c) {
  a = normalize(a), b = normalize(b), c = normalize(c);
  return 2 * abs(atan(dot(a, cross(b, c)), 1 + dot(a, b) + dot(b, c) + dot(c, a)));
}

#if FILLED
// The part in front of the plane z = 0: the map's other half shows the rest.
float solid_angle(vec3 a, vec3 b, vec3 c) {
  int front = int(a.z > 0) + int(b.z > 0) + int(c.z > 0);
  if (front == 0) return 0;
  float whole = whole_solid_angle(a, b, c);
  if (front == 3) return whole;
  // Turn the corners until a is alone on its side of the plane.
  while ((a.z > 0) != (front == 1)) {
    vec3 first = a;
    a = b, b = c, c = first;
  }
  float tip = whole_solid_angle(a, mix(a, b, a.z / (a.z - b.z)), mix(a, c, a.z / (a.z - c.z)));
  return front == 1 ? tip : whole - tip;
}
#else
float solid_angle(vec3 a, vec3 b, vec3 c) { return whole_solid_angle(a, b, c); }
#endif
