#include "envmap/io/images/detect_layout.h"

#include <fmt/ranges.h>

#include <algorithm>
#include <bit>
#include <span>
#include <vector>

#include "envmap/base/error.h"
#include "envmap/base/words.h"

namespace envmap {
namespace {

std::string shape(const Grid& g, Projection p) { return fmt::format("{}:{}", g.columns * aspect(p), g.rows); }

bool fits(int width, int height, Projection p, Layout layout) {
  const Grid g = grid(layout);
  return height % g.rows == 0 && static_cast<long>(height / g.rows) * aspect(p) * g.columns == width;
}

// Those of one square face, the last two with "or" between them.
std::string square_projections() {
  std::vector<std::string_view> names;
  for (const Projection p : all_projections)
    if (aspect(p) == 1 && faces(p) == 1) names.emplace_back(name(p));
  return enumerated(names);
}

std::optional<Layout> cube_layout_of_shape(int width, int height) {
  for (const Layout layout : {Layout::column, Layout::row, Layout::cross, Layout::vcross, Layout::grid3x2})
    if (fits(width, height, Projection::cube, layout)) return layout;
  return std::nullopt;
}

}  // namespace

FaceSize face_size(const DetectedLayout& base, int level) {
  const int height = std::max(1, base.size >> level);
  // A latlong image rounds each side by itself.
  const int width = base.projection == Projection::latlong ? std::max(1, 2 * base.size >> level) : height;
  return {width, height};
}

int complete_levels(const DetectedLayout& base) {
  const FaceSize first = face_size(base, 0);
  return int(std::bit_width(unsigned(std::max(first.width, first.height))));
}

void check_cube_layout(Layout layout) {
  check_enumerator("layout", layout);
  if (std::ranges::find(cube_layouts, layout) == std::end(cube_layouts))
    throw UsageError(fmt::format("{} is no layout of a cube's faces", name(layout)));
}

DetectedLayout detect_layout(int width, int height, const Metadata& said, const Metadata& recorded) {
  const std::string found = fmt::format("({}x{})", width, height);
  std::optional<Projection> p = said.projection ? said.projection : recorded.projection;
  std::optional<Layout> layout = said.layout;
  if (layout) check_cube_layout(*layout);
  if (!p && layout) p = Projection::cube;
  if (const auto table = recorded.facts.find(std::string(table_fact)); !p && table != recorded.facts.end())
    throw InputError(fmt::format("is the BRDF table of {} {}, not an environment map", table->second, found));
  if (!p) {
    if (width == height)
      throw InputError(fmt::format("a square image {} may be {}", found, square_projections()),
                       Remedy::choose_projection);
    if (fits(width, height, Projection::latlong, Layout::single))
      p = Projection::latlong;
    else if (cube_layout_of_shape(width, height))
      p = Projection::cube;
    else
      throw InputError(fmt::format(
          "no environment map has this shape {}: latlong and paraboloid are 2:1, cubes 1:6, 6:1, 4:3, 3:4 or 3:2, "
          "the others square",
          found));
  }
  if (layout && *p != Projection::cube)
    throw UsageError(fmt::format("a layout is for cube maps, not for a {} map", name(*p)));
  if (!layout && *p == Projection::cube) {
    if (recorded.layout && recorded.layout != Layout::files && fits(width, height, *p, *recorded.layout))
      layout = recorded.layout;
    else
      layout = cube_layout_of_shape(width, height);
    if (!layout) throw InputError(fmt::format("not a cube map {}: those are 1:6, 6:1, 4:3, 3:4 or 3:2", found));
  }
  if (!layout) layout = default_layout(*p);
  const Grid g = grid(*layout);
  if (!fits(width, height, *p, *layout)) {
    const std::string what = *p == Projection::cube ? fmt::format("{} cube", name(*layout)) : std::string(name(*p));
    throw InputError(fmt::format("not a {} {} image {}", shape(g, *p), what, found),
                     *p == Projection::sphere ? Remedy::find_circle : Remedy::none);
  }
  return {*p, *layout, height / g.rows};
}

}  // namespace envmap
