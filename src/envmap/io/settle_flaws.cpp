#include "envmap/io/settle_flaws.h"

#include <fmt/format.h>

#include "envmap/base/error.h"
#include "envmap/operate/measure.h"
#include "envmap/operate/refuse_flaws.h"

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
  throw InputError(name, flaw_words(flaws, level, shown), Remedy::repair);
}

}  // namespace

void settle_flaws(const std::string& name, const ReadOptions& options, Source& source) {
  for (std::size_t k = 0; k < source.map.levels.size(); ++k)
    settle(name, options, source.map.levels[k], source, k > 0 ? fmt::format(" of level {}", k) : "");
}

}  // namespace envmap
