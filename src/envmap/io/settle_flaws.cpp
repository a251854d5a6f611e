#include "envmap/io/settle_flaws.h"

#include <fmt/format.h>

#include "envmap/base/error.h"
#include "envmap/operate/measure.h"

namespace envmap {
namespace {

// @param shown what the message says after "texels".
void settle(const std::string& name, const ReadOptions& options, Level& level, Source& source,
                  const std::string& shown) {
  if (options.flaws == FlawPolicy::keep) return;
  const Flaws flaws = find_flaws(level);
  if (flaws.count() == 0) return;
  if (options.flaws == FlawPolicy::repair) {
    try {
      source.repaired += repair(level);
    } catch (const InputError& e) {
      throw InputError(name, e.what());
    }
    return;
  }
  std::string counts;
  const auto add = [&](std::int64_t n, const char* what) {
    if (n > 0) counts += fmt::format("{}{} {}", counts.empty() ? "" : ", ", n, what);
  };
  add(flaws.nan, "NaN");
  add(flaws.infinite, "infinite");
  add(flaws.negative, "negative");
  const std::string face = level.faces() > 1 ? fmt::format(" of face {}", flaws.first->face) : "";
  throw InputError(name,
                   fmt::format("{} of {} texels{} are no radiance ({}), the first at ({},{}){}", flaws.count(),
                               static_cast<std::int64_t>(level.faces()) * level.width() * level.height(), shown, counts,
                               flaws.first->i, flaws.first->j, face),
                   Remedy::repair);
}

}  // namespace

void settle_flaws(const std::string& name, const ReadOptions& options, Source& source) {
  for (std::size_t k = 0; k < source.map.levels.size(); ++k)
    settle(name, options, source.map.levels[k], source, k > 0 ? fmt::format(" of level {}", k) : "");
}

}  // namespace envmap
