#include "envmap/operate/refuse_flaws.h"

#include <fmt/format.h>

#include <atomic>
#include <bit>
#include <cstdint>
#include <limits>

#include "envmap/base/error.h"
#include "envmap/base/parallel.h"

namespace envmap {
namespace {

// All bits of its exponent are set where a float is NaN or infinite.
bool is_finite(float x) {
  constexpr std::uint32_t exponent = 0x7f800000;
  return (std::bit_cast<std::uint32_t>(x) & exponent) != exponent;
}
bool is_radiance(float x) { return x >= 0 && x <= std::numeric_limits<float>::max(); }

// The inner loop has no branches: it runs at the memory's pace.
template <bool is_sound(float)>
bool all(const Level& level) {
  std::atomic<bool> sound{true};
  parallel_ranges(level.faces() * level.height(), 16, [&](int begin, int end) {
    for (int k = begin; k < end; ++k) {
      std::uint32_t bad = 0;
      for (const Colour& c : level.row(k / level.height(), k % level.height()))
        for (const float x : {c.x, c.y, c.z}) bad |= std::uint32_t{!is_sound(x)};
      if (bad != 0) sound = false;
    }
    level.trim();
  });
  return sound;
}

}  // namespace

bool all_finite(const Level& level) { return all<is_finite>(level); }

std::string flaw_words(const Flaws& flaws, const Level& level, const std::string& shown) {
  std::string counts;
  const auto add = [&](std::int64_t n, const char* what) {
    if (n > 0) counts += fmt::format("{}{} {}", counts.empty() ? "" : ", ", n, what);
  };
  add(flaws.nan, "NaN");
  add(flaws.infinite, "infinite");
  add(flaws.negative, "negative");
  const std::string face = level.faces() > 1 ? fmt::format(" of face {}", flaws.first->face) : "";
  return fmt::format("{} of {} texels{} are no radiance ({}), the first at ({},{}){}", flaws.count(),
                     std::int64_t{level.faces()} * level.width() * level.height(), shown, counts, flaws.first->i,
                     flaws.first->j, face);
}

const Level& require_finite(const Level& level, const std::string& shown) {
  if (all_finite(level)) return level;
  // Texels beside a disc carry no weight; negative ones are no obstacle to sums and means.
  if (const Flaws flaws = find_flaws(level); flaws.nan + flaws.infinite > 0)
    throw InputError(flaw_words(flaws, level, shown), Remedy::repair);
  return level;
}

const EnvironmentMap& require_finite(const EnvironmentMap& map) {
  require_finite(map.base());
  return map;
}

const EnvironmentMap& require_radiance(const EnvironmentMap& map) {
  if (all<is_radiance>(map.base())) return map;
  if (const Flaws flaws = find_flaws(map.base()); flaws.count() > 0)
    throw InputError(flaw_words(flaws, map.base()), Remedy::repair);
  return map;
}

void require_no_overflow(const Level& scaled, const std::string& factor, const std::string& field) {
  if (!all_finite(scaled))
    throw UsageError(fmt::format("radiance exceeds 3.4e38, the largest float, at {}: lower the {}", factor, field));
}

}  // namespace envmap
