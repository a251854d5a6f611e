/// @file
/// Light on grids in the making, and the finest ones of a source.
#pragma once

#include <span>
#include <vector>

#include "envmap/base/large_pages.h"
#include "envmap/map/environment_map.h"
#include "envmap/prefilter/lagrange.h"
#include "envmap/prefilter/multilevel_kernels.h"

namespace envmap::prefiltering {

/// Every row with all columns; three channels, one after another.
struct LightPlanes {
  int rows, columns;
  std::vector<float, LargePages<float>> light;
  LightPlanes(int of_rows, int of_columns)
      : rows(of_rows), columns(of_columns), light(3 * std::size_t(of_rows) * std::size_t(of_columns)) {}
  [[nodiscard]] std::span<float> row(int row, int channel) {
    return std::span(light).subspan((std::size_t(row) * 3 + std::size_t(channel)) * std::size_t(columns),
                                    std::size_t(columns));
  }
  [[nodiscard]] std::span<const float> row(int r, int channel) const {
    return const_cast<LightPlanes*>(this)->row(r, channel);
  }
};

/// out += weight x in, `in` turned by half of its columns if wanted.
inline void add_row(std::span<const float> in, const Term& term, std::span<float> out) {
  if (!term.turned) return add_scaled(in, term.weight, out);
  const std::size_t half = in.size() / 2;
  add_scaled(in.subspan(half), term.weight, out.first(in.size() - half));
  add_scaled(in.first(half), term.weight, out.last(half));
}

/// The finest grid of a map, twice as wide as high. @param unit that radiance is counted in. @param darkest taken off.
LightPlanes latlong_planes(const Level& source, double unit, const Colour& darkest, int rows);
LightPlanes cube_planes(const Level& source, double unit, const Colour& darkest, int rows);

}  // namespace envmap::prefiltering
