// projection/latlong.h
vec3 latlong_located(vec3 d) { return vec3(0.5 - atan(d.x, d.z) / (2 * PI), 0.5 - atan(d.y, length(d.xz)) / PI, 0); }
