#include "envmap/io/display.h"

#include <algorithm>

#include "envmap/base/bounds.h"

namespace envmap {
namespace {

using Radiance = Rgb<double>;

double largest(const Radiance& c) { return std::max(c.x, std::max(c.y, c.z)); }

// What a dielectric reflects at least, 0.04, is taken away, so that base colours come out as they are.
Radiance neutral(Radiance c) {
  constexpr double start = 0.8 - 0.04, room = 1 - start, desaturation = 0.15;
  const double least = std::min(c.x, std::min(c.y, c.z));
  c -= least < 0.08 ? least - 6.25 * least * least : 0.04;
  const double peak = largest(c);
  if (peak < start) return c;
  const double drawn_in = 1 - room * room / (peak + room - start);
  const double white = 1 - 1 / (desaturation * (peak - drawn_in) + 1);
  return glm::mix(c * (drawn_in / peak), Radiance(drawn_in), white);
}

Radiance shown(const Radiance& c, Display display) {
  switch (display) {
    case Display::reinhard: return c / (1.0 + c);
    case Display::neutral: return neutral(c);
    case Display::clip: break;
  }
  return c;
}

}  // namespace

void show(std::span<Colour> pixels, Display display, double exposure) {
  check_enumerator("display", display);
  check_range({"exposure", 0, limits::gain.most}, exposure);
  for (Colour& c : pixels) c = Colour(glm::clamp(shown(exposure * Radiance(c), display), 0.0, 1.0));
}

}  // namespace envmap
