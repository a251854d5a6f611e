// Nodes of a grid and directions in its coordinates.
#include "envmap/prefilter/multilevel/node_grid.h"

#include <algorithm>

#include "envmap/maths/portable.h"

namespace envmap::prefiltering {

GridView::GridView(const Direction& n)
    : longitude(portable::atan2(n.x, -n.z)), sine(portable::hypot(n.x, n.z)), angle(portable::atan2(sine, n.y)) {
  if (longitude < 0) longitude += 2 * pi;
  half_sine = portable::sin_pi(0.5 * angle / pi), half_cosine = portable::cos_pi(0.5 * angle / pi);
}

GridView::GridView(double at_longitude, double at_angle)
    : longitude(at_longitude),
      sine(portable::sin_pi(at_angle / pi)),
      half_sine(portable::sin_pi(0.5 * at_angle / pi)),
      half_cosine(portable::cos_pi(0.5 * at_angle / pi)),
      angle(at_angle) {}

NodeGrid::NodeGrid(int of_rows) : rows(of_rows) {
  std::size_t size = 0;
  for (int r = 0; r < rows; ++r) {
    const double part = (r + 0.5) / rows, sine_here = portable::sin_pi(part);
    int count = 2 * rows;
    for (double s = 2 * sine_here; s <= 1 && count > 64 && count % 16 == 0; s *= 2) count /= 2;
    columns.push_back(count), first.push_back(size);
    sine.push_back(float(sine_here));
    half_sine.push_back(portable::sin_pi(0.5 * part)), half_cosine.push_back(portable::cos_pi(0.5 * part));
    size += 3 * stride(r);
  }
  values.resize(size);
}

void NodeGrid::repeat_columns(int row) {
  for (int c = 0; c < 3; ++c) {
    float* to = channel(row, c);
    std::copy_n(to, padding, to + columns[std::size_t(row)]);
  }
}

GridView NodeGrid::node(int row, int column) const {
  return {(column + 0.5) * 2 * pi / columns[std::size_t(row)], (row + 0.5) * pi / rows};
}

}  // namespace envmap::prefiltering
