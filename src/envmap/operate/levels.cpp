#include "envmap/operate/levels.h"

#include <algorithm>
#include <array>

#include "envmap/operate/parallel.h"

namespace envmap {
namespace {

// A part of a source texel that a texel of the result covers, along one axis.
struct Part {
  int index;        // Of the source texel.
  double from, to;  // In units of the face.
};

// What a texel of the result covers along one axis: halving a size covers two texels, or parts of three.
struct Parts {
  std::array<Part, 3> parts;
  std::size_t count = 0;

  [[nodiscard]] const Part* begin() const { return parts.data(); }
  [[nodiscard]] const Part* end() const { return parts.data() + count; }
};

// What texel k of `coarse` covers of `fine` texels; exact in doubles up to 2^26 texels a side.
Parts parts(int k, int coarse, int fine) {
  const double from = static_cast<double>(k) * fine / coarse, to = static_cast<double>(k + 1) * fine / coarse;
  Parts found;
  for (int i = static_cast<int>(from); i < to; ++i)
    found.parts[found.count++] = {i, std::max<double>(from, i) / fine, std::min<double>(to, i + 1) / fine};
  return found;
}

// Texel i of one row of every face; the faces share their weights.
template <class P>
void halve_texel(const Level& fine, const Parts& rows, const Parts& columns, int i, int row, Level& coarse) {
  std::array<Flux, P::faces> sums{};
  double whole = 0;
  const auto add = [&](const Part& x, const Part& y, double w) {
    whole += w;
    for (int f = 0; f < P::faces; ++f) sums[static_cast<std::size_t>(f)] += w * Flux(*fine.texel(f, x.index, y.index));
  };
  for (const Part& y : rows)
    for (const Part& x : columns) add(x, y, P::solid_angle({x.from, y.from, x.to, y.to}));
  if (whole == 0 && P::filled) {
    for (const Part& y : rows)
      for (const Part& x : columns) add(x, y, (y.to - y.from) * (x.to - x.from));
  }
  if (whole == 0) return;
  for (int f = 0; f < P::faces; ++f) *coarse.texel(f, i, row) = Colour(sums[static_cast<std::size_t>(f)] / whole);
}

}  // namespace

Level half_level(const Level& fine) {
  Level coarse(fine.projection(), std::max(1, fine.height() / 2));
  visit(fine.projection(), [&](auto p) {
    for_each_row(1, coarse.height(), {}, [&](int, int row) {
      const Parts rows = parts(row, coarse.height(), fine.height());
      for (int i = 0; i < coarse.width(); ++i)
        halve_texel<decltype(p)>(fine, rows, parts(i, coarse.width(), fine.width()), i, row, coarse);
    });
  });
  return coarse;
}

void add_levels(std::vector<Level>& levels) {
  while (levels.back().height() > 1) levels.push_back(half_level(levels.back()));
}

}  // namespace envmap
