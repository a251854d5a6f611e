#include "envmap/engine/level_roughness.h"

#include <fmt/format.h>

#include <bit>

#include "envmap/base/bounds.h"
#include "envmap/base/error.h"

namespace envmap {

std::vector<double> level_roughnesses(const EngineMap& map, int size, std::optional<int> levels,
                                      std::string_view size_name) {
  check_range(limits::size, size);
  if (!map.chain) throw UsageError(fmt::format("{} has no chain", map.file));
  const int possible = std::bit_width(unsigned(size)), fixed = levels.value_or(map.chain->levels);
  const int count = fixed > 0 ? fixed : possible - std::bit_width(unsigned(map.chain->last)) + 1;
  if (count < 1)
    throw UsageError(fmt::format("{} {}: {} has levels down to {}", size_name, size, map.file, map.chain->last));
  if (count > possible) throw UsageError(fmt::format("{} {}: {} has {} levels", size_name, size, map.file, count));
  std::vector<double> roughnesses;
  for (int k = 0; k < count; ++k) roughnesses.push_back(count > 1 ? map.chain->roughness(k, count, size) : 0);
  return roughnesses;
}

}  // namespace envmap
