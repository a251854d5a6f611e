// The rays through the texels, in the frame of the map: from the viewpoint, 0 where a texel is no part of it; or, where w
// is 1, parallel ones along -Z, from (x, y, 0).
layout(binding = UNIT_RAYS) uniform sampler2D rays;
uniform float spread;        // Distance of samples, in texels: the root of 1 / their number.
uniform float below_centre;  // How far this sample lies below the centre of its texel, in texels.

struct Ray {
  vec3 from, along;
};

Ray ray_at(ivec2 texel) {
  vec4 ray = texelFetch(rays, texel, 0);
  return ray.w == 0 ? Ray(vec3(0), ray.xyz) : Ray(vec3(ray.xy, 0), vec3(0, 0, -1));
}
