#include "envmap/map/layout.h"

#include <array>

namespace envmap {
namespace {

constexpr std::array<Slot, 1> single_slots{{{0, 0}}};
constexpr std::array<Slot, 2> pair_slots{{{0, 0}, {1, 0}}};
constexpr std::array<Slot, 6> column_slots{{{0, 0}, {0, 1}, {0, 2}, {0, 3}, {0, 4}, {0, 5}}};
constexpr std::array<Slot, 6> row_slots{{{0, 0}, {1, 0}, {2, 0}, {3, 0}, {4, 0}, {5, 0}}};
constexpr std::array<Slot, 6> grid_slots{{{0, 0}, {1, 0}, {2, 0}, {0, 1}, {1, 1}, {2, 1}}};
// The crosses are the cube unfolded, seen from inside, -Z in the middle: every pair of neighbours in the picture share
// that edge on the cube. In the vertical cross +Z hangs below -Y and so stands on its head.
constexpr std::array<Slot, 6> cross_slots{{{2, 1}, {0, 1}, {1, 0}, {1, 2}, {3, 1}, {1, 1}}};
constexpr std::array<Slot, 6> vcross_slots{{{2, 1}, {0, 1}, {1, 0}, {1, 2}, {1, 3, true}, {1, 1}}};

}  // namespace

std::string_view name(Layout layout) {
  check_enumerator("layout", layout);
  switch (layout) {
    case Layout::single: return "single";
    case Layout::pair: return "pair";
    case Layout::column: return "column";
    case Layout::row: return "row";
    case Layout::cross: return "cross";
    case Layout::vcross: return "vcross";
    case Layout::grid3x2: return "3x2";
    case Layout::files: return "files";
    case Layout::api: break;
  }
  return "api";
}

std::optional<Layout> layout_named(std::string_view wanted) {
  for (const Layout layout : cube_layouts)
    if (wanted == name(layout)) return layout;
  return std::nullopt;
}

Grid grid(Layout layout) {
  check_enumerator("layout", layout);
  switch (layout) {
    case Layout::single: return {1, 1, single_slots};
    case Layout::pair: return {2, 1, pair_slots};
    case Layout::row: return {6, 1, row_slots};
    case Layout::cross: return {4, 3, cross_slots};
    case Layout::vcross: return {3, 4, vcross_slots};
    case Layout::grid3x2: return {3, 2, grid_slots};
    case Layout::column:
    case Layout::files:
    case Layout::api: break;
  }
  return {1, 6, column_slots};
}

Layout default_layout(Projection p) {
  return p == Projection::cube ? Layout::column : p == Projection::paraboloid ? Layout::pair : Layout::single;
}

}  // namespace envmap
