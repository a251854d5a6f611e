#include "envmap/io/texels/rounding.h"

#include <algorithm>
#include <cmath>

#include "envmap/io/formats/file_format.h"
#include "envmap/io/texels/texels.h"
#include "envmap/io/write_plan.h"
#include "envmap/map/octahedral_border.h"
#include "envmap/operate/levels.h"

namespace envmap {

std::optional<Rounding> rounding_of(const std::string& path, const WriteOptions& options) {
  const FileFormat& format = *format_with_extension(extension(path, options));
  const Depth depth = choose_depth(format, options);
  const std::string& c = options.compression;
  const bool lossy = c.starts_with("b44") || c.starts_with("dwa") || (c == "pxr24" && depth == Depth::single);
  if (is_integer(depth) || lossy || options.openexr_envmap) return std::nullopt;
  if (depth == Depth::single && !format.round) return Rounding{depth};
  if (format.round)
    return Rounding{depth, 0x1p-8, [round = format.round](const Level& level) {
                      const Rows rows = rows_of(level, Forward::plus_z);
                      Rows rounded = rows;
                      rounded.fill = [&rows, round](int face, int row, std::span<Colour> out) {
                        rows.fill(face, row, out);
                        round(out);
                      };
                      return level_of(rounded);
                    }};
  const std::optional<double> largest = depth == Depth::bc6h || depth == Depth::uastc_hdr || depth == Depth::rgbd
                                            ? std::nullopt
                                            : std::optional(range_of(depth, format.largest).precision);
  return Rounding{depth, largest, [depth, border = options.border](const Level& level) {
                    if (border == 0) return envmap::read_back(level, texels_of(depth));
                    return without_border(envmap::read_back(with_border(level, border), texels_of(depth)), border);
                  }};
}

bool bounds_every_channel(const Rounding& rounding, double floor) {
  constexpr double least_normal = 0x1p-14;  // Of half: below it steps are all alike.
  return !rounding.read_back || (rounding.depth == Depth::half && floor >= least_normal);
}

std::string_view name(const Rounding& rounding) {
  return rounding.read_back && rounding.depth == Depth::single ? "a shared exponent" : name(rounding.depth);
}

double rounding_error(const Rounding& rounding, const Level& level, double floor) {
  if (!rounding.read_back) return 0;
  const Level read = rounding.read_back(level);
  double most = 0;
  for (int face = 0; face < level.faces(); ++face)
    for (int j = 0; j < level.height(); ++j) {
      const std::span<const Colour> made = level.row(face, j), back = read.row(face, j);
      for (std::size_t k = 0; k < made.size(); ++k)
        for (int c = 0; c < 3; ++c)
          if (const double off = std::abs(double{back[k][c]} - made[k][c]); off > 0)
            most = std::max(most, off / std::max<double>(made[k][c], floor));
    }
  return most;
}

}  // namespace envmap
