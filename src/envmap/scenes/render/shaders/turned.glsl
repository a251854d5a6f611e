// Where a ray goes on from a surface: reflected where bend is 0, else refracted.
vec3 turned(vec3 ray, vec3 normal, float bend) { return bend == 0 ? reflect(ray, normal) : refract(ray, normal, bend); }
