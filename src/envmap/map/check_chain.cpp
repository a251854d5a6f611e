#include "envmap/map/check_chain.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>

#include "envmap/base/error.h"

namespace envmap {

void check_face_size(Projection projection, const LevelSize& face) {
  check_range(limits::level_height, face.height);
  check_range(limits::level_width, face.width);
  if (const int full = face.height * aspect(projection); face.width != full && projection != Projection::latlong)
    throw UsageError(fmt::format("faces {} texels high of a {} map are {} wide, not {}", face.height, name(projection),
                                 full, face.width));
}

int possible_levels(const LevelSize& base) { return int(std::bit_width(unsigned(std::max(base.width, base.height)))); }

void check_level_count(const LevelSize& base, std::size_t count, const std::string& path) {
  if (count > std::size_t(possible_levels(base)))
    throw UsageError(path, fmt::format("{}x{} has at most {} levels, not {}", base.width, base.height,
                                       possible_levels(base), count));
}

void check_halving(std::span<const LevelSize> levels, const std::string& path) {
  for (std::size_t k = 0; k < levels.size(); ++k) {
    const int shift = int(std::min<std::size_t>(k, 31));
    const int width = std::max(1, levels[0].width >> shift), height = std::max(1, levels[0].height >> shift);
    if (levels[k].width != width || levels[k].height != height)
      throw UsageError(path,
                       fmt::format("level {} is {}x{}, not {}x{}", k, levels[k].width, levels[k].height, width, height),
                       Remedy::make_levels);
  }
}

}  // namespace envmap
