/// @file
/// Cells: what a texel is cut into, rectangles of the image or wedges of a sphere map's rim.
#pragma once

#include "envmap/prefilter/wedge.h"

namespace envmap {

/// f(part) for the parts of a cell.
template <class P, class F>
void for_parts(const Rect& rect, F&& f) {
  if constexpr (has_wedges<P>) {
    if (at_rim<P>(rect)) return for_wedges(rect, f);
  }
  for (const Rect& q : quarters(rect)) f(q);
}
template <class P, class F>
void for_parts(const Wedge& wedge, F&& f) {
  for_halves(wedge, f);
}

/// Moments of a cell that needs no cutting: nothing where it spans more than 0.05 radians and `anyway` is not set.
template <class P>
std::optional<Patch> small_cell(int face, const Rect& rect, bool anyway = false) {
  if (at_rim<P>(rect) && coverage<P>(rect) == Coverage::cut) return std::nullopt;
  return small_patch<P>(face, rect, anyway);
}
template <class P>
std::optional<Patch> small_cell(int /*face*/, const Wedge& wedge, bool anyway = false) {
  return small_patch(wedge, anyway);
}

/// Whether the moments of a cell are rough as they stand.
template <class P>
bool is_cut(const Rect& rect) {
  return coverage<P>(rect) == Coverage::cut;
}
template <class P>
bool is_cut(const Wedge& /*wedge*/) {
  return false;
}

/// Moments of any cell, by its parts where it is not small.
template <class P, class Cell>
Patch patch(int face, const Cell& cell, int depth = 0) {
  const bool rough = depth < 3 && is_cut<P>(cell);
  if (!rough)
    if (const std::optional<Patch> found = small_cell<P>(face, cell, depth >= 9)) return *found;
  std::array<Patch, 10> parts;  // The most that a cell is cut into.
  std::size_t count = 0;
  for_parts<P>(cell, [&](const auto& part) { parts[count++] = patch<P>(face, part, depth + 1); });
  return united(std::span(parts).first(count));
}

/// f(direction, solid angle) at Gauss points of a cell, cut until none of its parts spans more than `across` radians.
template <class P, class F>
void for_points(int face, const Wedge& wedge, double across, F&& f, int depth = 0) {
  if (depth < 9 && wedge.far - wedge.near > across) {
    for_halves(wedge, [&](const Wedge& half) { for_points<P>(face, half, across, f, depth + 1); });
  } else {
    wedge.points(f);
  }
}
template <class P, class F>
void for_points(int face, const Rect& rect, double across, F&& f, int depth = 0) {
  const Coverage where = coverage<P>(rect);
  if (where == Coverage::outside) return;
  const auto parts = [&] {
    for_parts<P>(rect, [&](const auto& part) { for_points<P>(face, part, across, f, depth + 1); });
  };
  if (at_rim<P>(rect)) return parts();
  std::array<Direction, 4> points;
  std::array<double, 4> weights;
  gauss_points<P>(face, rect, points, weights);
  const double diagonal = 1.75 * std::max(glm::length(points[0] - points[3]), glm::length(points[1] - points[2]));
  if ((depth < 9 && diagonal > across) || (where == Coverage::cut && depth < 3)) {
    parts();
  } else if (where == Coverage::cut) {
    const Patch p = patch<P>(face, rect);
    if (p.solid_angle > 0) f(glm::normalize(p.centre), p.solid_angle);
  } else {
    for (std::size_t k = 0; k < 4; ++k) f(points[k], weights[k]);
  }
}

}  // namespace envmap
