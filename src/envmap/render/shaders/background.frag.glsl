// What is behind all surfaces. A ray of length 0 is outside the disc of the map: nothing.
layout(location = 0) out vec4 colour;  // Radiance, and 1 / distance.
uniform mat3 to_world;  // From the map.
uniform float weight;
uniform vec3 behind;    // Light from there beside the environment's.

void main() {
  vec3 ray = ray_at(ivec2(gl_FragCoord.xy)).along;
  vec3 radiance = ray == vec3(0) ? vec3(0) : behind + environment_at(to_world * ray);
  colour = vec4(weight * radiance, 0);
}
