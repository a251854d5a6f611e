#include <algorithm>
#include <cmath>

#include "envmap/maths/quadrature.h"
#include "envmap/prefilter/hinge_grid.h"

namespace envmap::prefiltering {

namespace {

// Gauss points of 1 / r^4 and 1 / r^5 over a square: two a side are off by 1e-12 of it where it is this small, and
// three by 1e-11 up to 1/32.
constexpr double small = 0.002;

// f(s, t, weight x area) at Gauss points of a rectangle.
template <class F>
void at_points(double s, double t, double half, F&& f) {
  const auto go = [&](const auto& rule) {
    for (std::size_t b = 0; b < rule.node.size(); ++b)
      for (std::size_t a = 0; a < rule.node.size(); ++a)
        f(s + half * rule.node[a], t + half * rule.node[b], half * half * rule.weight[a] * rule.weight[b]);
  };
  if (2 * half <= small)
    go(quadrature::rule<2>());
  else
    go(quadrature::rule<3>());
}

// Largest and least 1 / r of a rectangle, and by how much powers of them differ from those of the middle.
struct Distances {
  double middle, near, far;
  Distances(double x, double half_x, double y, double half_y) {
    const double near_x = std::max(0.0, std::abs(x) - half_x), near_y = std::max(0.0, std::abs(y) - half_y);
    const double far_x = std::abs(x) + half_x, far_y = std::abs(y) + half_y;
    middle = 1 / std::sqrt(1 + x * x + y * y);
    near = 1 / std::sqrt(1 + near_x * near_x + near_y * near_y);
    far = 1 / std::sqrt(1 + far_x * far_x + far_y * far_y);
  }
  [[nodiscard]] double uneven(int power) const { return prefiltering::uneven(near / middle, far / middle, power); }
};

}  // namespace

CubeGrid::CubeGrid(int /*width*/, int height) : size_(height) {}

CubeGrid::Row CubeGrid::row(int row, int order) const {
  Row made{std::vector<std::array<double, hinge_moments.back()>>(std::size_t(size_))};
  for (int i = 0; i < size_; ++i) {
    const Part p = texel({}, row, i);
    auto& m = made.moments[std::size_t(i)];
    at_points(p.x, p.y, p.half, [&](double s, double t, double weight) {
      const double q = 1 / std::sqrt(1 + s * s + t * t), o = weight * q * q * q, x = s * q, y = t * q;
      m[0] += o, m[1] += o * x, m[2] += o * y, m[3] += o * q;
      if (order > 1)
        m[4] += o * x * x, m[5] += o * y * y, m[6] += o * q * q, m[7] += o * x * y, m[8] += o * x * q,
            m[9] += o * y * q;
      if (order > 2)
        m[10] += o * x * x * x, m[11] += o * x * x * y, m[12] += o * x * x * q, m[13] += o * x * y * y,
            m[14] += o * x * y * q, m[15] += o * y * y * y, m[16] += o * y * y * q;
    });
  }
  return made;
}

void CubeGrid::Row::add(std::span<const Colour> texels, int first, int order, HingeBlock& block) const {
  const std::size_t count = hinge_moments[std::size_t(order)];
  for (std::size_t i = 0; i < texels.size(); ++i) {
    const auto& weights = moments[std::size_t(first) + i];
    const Flux light(texels[i]);
    block.least = glm::min(block.least, texels[i]);
    for (std::size_t m = 0; m < count; ++m)
      for (std::size_t k = 0; k < 3; ++k) block.moments[m][k] += weights[m] * light[int(k)];
  }
}

CubeGrid::Cells CubeGrid::cells(int side) const {
  Cells made{{size_, side}, {size_, side}, {}, {}};
  const int count = made.across.count();
  std::vector<std::array<double, 4>> sums(static_cast<std::size_t>(count));
  for (int k = 0; k < count; ++k) {
    std::ranges::fill(sums, std::array<double, 4>{});
    for (int j = made.down.first(k); j < made.down.end(k); ++j) {
      const Row texels = row(j, 1);
      for (int i = 0; i < size_; ++i)
        for (std::size_t m = 0; m < 4; ++m) sums[std::size_t(i / side)][m] += texels.moments[std::size_t(i)][m];
    }
    const double y = 1 - double(made.down.first(k) + made.down.end(k)) / size_,
                 half_y = double(made.down.end(k) - made.down.first(k)) / size_;
    for (int i = 0; i < count; ++i) {
      const double x = double(made.across.first(i) + made.across.end(i)) / size_ - 1;
      const double half_x = double(made.across.end(i) - made.across.first(i)) / size_;
      const Distances r(x, half_x, y, half_y);
      const auto& [o, mx, my, mz] = sums[std::size_t(i)];
      const double weight = 4 * half_x * half_y * r.middle * r.middle * r.middle * r.middle / o;
      made.shapes.push_back({.near = r.near,
                             .far = r.far,
                             .solid_angle = o,
                             .mean = {mx / o, my / o, mz / o},
                             .weight1 = weight,
                             .uneven1 = r.uneven(4),
                             .weight2 = weight * r.middle,
                             .uneven2 = r.uneven(5)});
    }
  }
  return made;
}

RowSpan CubeGrid::Cells::span(const FaceDirection& n, const double* /*angles*/, int row) const {
  const int count = across.count();
  const double top = 1 - 2.0 * down.first(row) / across.texels, bottom = 1 - 2.0 * down.end(row) / across.texels;
  const double low = n.z + std::min(n.y * top, n.y * bottom), high = n.z + std::max(n.y * top, n.y * bottom);
  const double slope = std::max(std::abs(n.x), 1e-300);
  if (low >= slope) return {0, 0, count, count};
  if (high <= -slope) return {0, 0, 0, 0};
  // Columns from the side where L is least: from `any` on they have light above the horizon,
  // from `all` on nothing else.
  const auto column = [&](double x) {
    return std::clamp(int(0.5 * (x + 1) * across.texels) / across.side, 0, count - 1);
  };
  constexpr double margin = 1e-12;
  const double any = std::clamp(-high / slope - margin, -1.0, 1.0), all = std::clamp(-low / slope + margin, -1.0, 1.0);
  if (n.x >= 0) {
    const int first = low >= slope ? 0 : column(all) + 1;
    return {column(any), first, count, count};
  }
  const int last = column(-all);
  return {0, 0, last, column(-any) + 1};
}

PartView CubeGrid::Part::view(const FaceDirection& n) const {
  PartView v{};
  at_points(x, y, half, [&](double s, double t, double weight) {
    const double q = 1 / std::sqrt(1 + s * s + t * t), o = weight * q * q * q, along = (n.x * s + n.y * t + n.z) * q;
    v.solid_angle += o, v.first += o * along, v.second += o * along * along, v.third += o * along * along * along;
  });
  const Distances r(x, half, y, half);
  v.middle = n.x * x + n.y * y + n.z;
  v.across = std::abs(n.x) * half, v.down = std::abs(n.y) * half;
  v.weight1 = 4 * half * half * r.middle * r.middle * r.middle * r.middle, v.uneven1 = r.uneven(4);
  v.weight2 = v.weight1 * r.middle, v.uneven2 = r.uneven(5);
  return v;
}

Division<CubeGrid::Part> CubeGrid::Part::divided() const {
  const double q = 0.5 * half;
  return {{{{x - q, y - q, q}, {x + q, y - q, q}, {x - q, y + q, q}, {x + q, y + q, q}}}, 4};
}

}  // namespace envmap::prefiltering
