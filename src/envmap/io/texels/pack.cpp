#include "envmap/io/texels/pack.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <limits>
#include <span>

#include "envmap/base/error.h"
#include "envmap/base/run_operation.h"
#include "envmap/io/texels/api_orientation.h"
#include "envmap/io/texels/texels.h"
#include "envmap/io/texels/texture_file.h"
#include "envmap/io/texels/value_range.h"
#include "envmap/map/atlas.h"
#include "envmap/map/layout.h"
#include "envmap/operate/measure.h"
#include "envmap/operate/refuse_flaws.h"

namespace envmap {
namespace {

constexpr std::array texels_of_format{Texels::rgba16f, Texels::rgba32f, Texels::rgb16f,
                                      Texels::rgb32f,  Texels::rgb9e5,  Texels::bc6h_ufloat};

const TexelFormat& format_of(PixelFormat format) { return format_of(texels_of_format[number_of("format", format)]); }

// Each level as it is packed, and what of it does not fit.
struct Stored {
  Stored(const Level& level, const TexelFormat& format, bool api)
      : plain(rows_of(level, Forward::plus_z)),
        limited(plain, range_of(format.depth, std::numeric_limits<float>::max()), true),
        rows(api && level.projection() == Projection::cube ? in_api_orientation(limited.rows()) : limited.rows()) {}

  Rows plain;
  ClampedRows limited;
  Rows rows;
};

void check(const Level& level, const TexelFormat& format, const std::string& which) {
  require_finite(level, which);
  const bool has_sign = format.depth != Depth::rgb9e5 && format.depth != Depth::bc6h;
  if (const Flaws flaws = has_sign ? Flaws{} : find_flaws(level); flaws.negative > 0)
    throw UsageError(flaw_words(flaws, level, which), Remedy::repair);
}

std::size_t aligned(std::size_t bytes, int to) {
  const auto step = std::size_t(to);
  return (bytes + step - 1) / step * step;
}

PackedMap::Part part_of(const TexelFormat& format, const Level& level, int alignment, std::size_t offset) {
  const std::size_t row = aligned(format.row_bytes(level.width()), alignment);
  return {offset, row * format.blocks(level.height()), level.width(), level.height(), row};
}

// One image into its place. BC6H looks at blocks beside each other, so that an image is packed whole.
void put(const Atlas& image, const TexelFormat& format, const PackedMap::Part& part, std::span<std::byte> to) {
  std::vector<Colour> texels(std::size_t(part.width) * std::size_t(part.height));
  image.gather(0, part.height, texels);
  std::vector<std::byte> tight;
  encode_rows(format, image, 0, part.height, texels, tight);
  const std::size_t row = format.row_bytes(part.width);
  for (std::size_t k = 0; k * row < tight.size(); ++k)
    std::ranges::copy(std::span(tight).subspan(k * row, row), to.subspan(part.offset + k * part.row_bytes).begin());
}

void check_fit(const ClampStatistics& level, const TexelFormat& format, const PackOptions& options, PackedMap& made) {
  if (level.over > 0 && !options.clamp)
    throw UsageError(fmt::format("{} texels over {:g} do not fit {}: take rgba32f or rgb32f", level.over,
                                 range_of(format.depth, 0).largest, format.name),
                     Remedy::clamp_or_dim);
  if (level.flux > 0) made.flux_lost = std::max(made.flux_lost, level.cut / level.flux);
}

}  // namespace

const PackedMap::Part& PackedMap::part(int level, int face) const {
  check_range({"level", 0, levels - 1.0}, level);
  check_range({"face", 0, faces - 1.0}, face);
  return parts.at(std::size_t(level * faces + face));
}

std::span<const std::byte> PackedMap::level(int level) const {
  const Part &first = part(level, 0), &last = part(level, faces - 1);
  return std::span(bytes).subspan(first.offset, last.offset + last.size - first.offset);
}

PackedMap pack(const EnvironmentMap& map, const PackOptions& options, const Run& run) {
  check_range({"row_alignment", 1, 4096}, options.row_alignment);
  check_enumerator("orientation", options.orientation);
  const TexelFormat& format = format_of(options.format);
  check_levels(map);
  const bool api = options.orientation == FaceOrientation::graphics_api;
  PackedMap made{.format = options.format, .faces = map.base().faces(), .levels = int(map.levels.size())};
  std::size_t size = 0;
  for (const Level& level : map.levels)
    for (int face = 0; face < made.faces; ++face) {
      made.parts.push_back(part_of(format, level, options.row_alignment, size));
      size += made.parts.back().size;
    }
  made.bytes.resize(size);
  run_operation(run, [&](const Progress& progress) {
    for (int k = 0; k < made.levels; ++k) {
      const Level& level = map.levels[std::size_t(k)];
      check(level, format, k > 0 ? fmt::format(" of level {}", k) : "");
      const Stored stored(level, format, api);
      const Grid grid = envmap::grid(default_layout(level.projection()));
      for (int face = 0; face < made.faces; ++face) {
        const PackedMap::Part& part = made.part(k, face);
        put({stored.rows, grid, face}, format, part, made.bytes);
        if (progress) progress(double(part.offset + part.size) / double(size));
      }
      check_fit(stored.limited.total(), format, options, made);
    }
  });
  return made;
}

}  // namespace envmap
