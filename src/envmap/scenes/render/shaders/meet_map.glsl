// Where a ray meets what a mirror's map shows. Source: Szirmay-Kalos, Aszodi, Lazanyi and Premecz 2005, "Approximate
// ray-tracing on the GPU with distance impostors"; a linear search, and then intervals are halved.
//
// Of the point (1 - s) p + s |p| r, up to a factor: s from 0 to 1 goes from p along r to infinity, in steps of about the same
// angle seen from the middle. excess() is how far it lies behind what the map shows, times (1 - s) / its distance: linear in s
// where that is a plane, and 0 at infinity where there is nothing.
const float steps_a_radian = 32;  // What is thinner is missed.
const float aside = 2;   // Texels: what is next to the edge of something does not show it.
const float jump = 0.1;  // Of the distance, within a sixteenth of a step: no surface is that steep.

float excess(vec3 p, vec3 to, float s) {
  vec3 x = mix(p, to, s);
  float far_off = length(x);
  return far_off * nearness_at(x / far_off) - (1 - s);
}

// All in the frame of the map. @param p from its middle. @param to |p| r. @return s.
float met(vec3 p, vec3 to) {
  float angle = acos(clamp(dot(normalize(p + to * 1e-20), normalize(to)), -1, 1));
  int steps = int(4 + steps_a_radian * angle);
  float low = 0, below = excess(p, to, 0), hidden = 1;
  for (int k = 1; k <= steps; ++k) {
    float high = float(k) / steps, above = excess(p, to, high), next = high, beyond = above;
    if (below < 0 && above >= 0) {
      for (int j = 0; j < 4; ++j) {
        float middle = 0.5 * (low + high), there = excess(p, to, middle);
        if (there < 0) low = middle, below = there;
        else high = middle, above = there;
      }
      // Where the map jumps the ray passes behind something: it may come out again. Nothing hides infinity.
      if (high == 1 || above - below < jump * (1 - low) + 1e-6) return mix(low, high, below / (below - above));
      if (hidden == 1)
        hidden = max(0, low - aside * texel_angle(normalize(mix(p, to, low)), 2.0 / textureSize(mirror, 0).x) / max(angle, 1e-3));
    }
    low = next, below = beyond;
  }
  return hidden;
}
