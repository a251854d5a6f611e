// Punctual lights and suns: GpuScene::lights_at(), in the world's axes, positions from the viewpoint.
struct Light {
  vec4 position;   // Of points and spots; w: its kind, an enumerator of PunctualLight::Kind in scene.h: POINT, SPOT, DIRECTIONAL.
  vec4 direction;  // That it shines in; w: its range, 0: no end.
  vec4 intensity;  // w: PlacedLight::spread, of suns.
  // Of spots: cosines of the inner and the outer half angle. z: its first image (shadow_view.h); w: how many.
  vec4 cone;
};
layout(std430, binding = BUFFER_LIGHTS) readonly buffer Lights { Light lights[]; };
