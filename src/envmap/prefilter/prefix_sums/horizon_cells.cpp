// Cells of a source that the horizon of an output direction cuts: cube faces, then latlong maps. horizon_cells.h has
// the coordinates.
#include "envmap/prefilter/prefix_sums/horizon_cells.h"

#include <algorithm>
#include <cmath>

#include "envmap/maths/portable.h"
#include "envmap/maths/quadrature.h"

namespace envmap::prefiltering {

// Cube faces.

namespace {

// The side of a square over which two Gauss points each way integrate 1 / r^4 and 1 / r^5 to 1e-12. Three do to 1e-11
// for sides up to 1/32.
constexpr double small = 0.002;

// Calls f(s, t, weight x area) at Gauss points of a square.
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

// 1 / r in the middle of a rectangle, its extremes over it, and the variation of its powers.
struct Distances {
  double middle, near, far;
  Distances(double x, double half_x, double y, double half_y) {
    const double near_x = std::max(0.0, std::abs(x) - half_x), near_y = std::max(0.0, std::abs(y) - half_y);
    const double far_x = std::abs(x) + half_x, far_y = std::abs(y) + half_y;
    middle = 1 / std::sqrt(1 + x * x + y * y);
    near = 1 / std::sqrt(1 + near_x * near_x + near_y * near_y);
    far = 1 / std::sqrt(1 + far_x * far_x + far_y * far_y);
  }
  [[nodiscard]] double variation(int power) const {
    return prefiltering::variation(near / middle, far / middle, power);
  }
};

}  // namespace

CubeGrid::CubeGrid(int /*width*/, int height) : size_(height) {}

CubeGrid::Row CubeGrid::row(int row, int order) const {
  Row made{std::vector<std::array<double, moment_counts.back()>>(std::size_t(size_))};
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

void CubeGrid::Row::add(std::span<const Colour> texels, int first, int order, BlockMoments& block) const {
  const std::size_t count = moment_counts[std::size_t(order)];
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
                             .variation1 = r.variation(4),
                             .weight2 = weight * r.middle,
                             .variation2 = r.variation(5)});
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
  // x from the side where L is least: a column has light above the horizon from `any` on, and no other from `all` on.
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
  v.weight1 = 4 * half * half * r.middle * r.middle * r.middle * r.middle, v.variation1 = r.variation(4);
  v.weight2 = v.weight1 * r.middle, v.variation2 = r.variation(5);
  return v;
}

Division<CubeGrid::Part> CubeGrid::Part::divided() const {
  const double q = 0.5 * half;
  return {{{{x - q, y - q, q}, {x + q, y - q, q}, {x - q, y + q, q}, {x + q, y + q, q}}}, 4};
}

// Latlong maps.

namespace {

constexpr int deepest = 13;  // Halvings of a texel.

double cot(double sine, double cosine) { return cosine / sine; }

}  // namespace

LatlongGrid::LatlongGrid(int width, int height) : width_(width), height_(height) {
  for (int k = 0; k <= deepest; ++k) {
    const double down = std::ldexp(0.5 / height, -k), across = std::ldexp(1.0 / width, -k);  // Angles over pi.
    halvings_.push_back({portable::sin_pi(down), portable::cos_pi(down), portable::sin_pi(across),
                         portable::cos_pi(across), portable::sin_pi(quadrature::gauss_3.node[2] * down),
                         portable::cos_pi(quadrature::gauss_3.node[2] * down), pi * across});
  }
  for (int j = 0; j < height; ++j)
    rows_.push_back({portable::cos_pi((j + 0.5) / height), portable::sin_pi((j + 0.5) / height)});
  const double once = 2 * portable::sin_pi(1.0 / width), twice = portable::sin_pi(2.0 / width),
               thrice = 2.0 / 3 * portable::sin_pi(3.0 / width);
  for (int i = 0; i < width; ++i) {
    const double cosine = portable::cos_pi((2.0 * i + 1) / width), sine = portable::sin_pi((2.0 * i + 1) / width);
    columns_.push_back({cosine, sine});
    across_.push_back({once * cosine, once * sine, pi / width + 0.5 * twice * (cosine * cosine - sine * sine),
                       twice * cosine * sine, 0.25 * cosine * (3 * once + thrice * (4 * cosine * cosine - 3)),
                       0.25 * sine * (once + thrice * (3 - 4 * sine * sine))});
  }
}

// Longitudes are 2 pi u: they start at -Z and rise towards +X.
FaceDirection LatlongGrid::seen(int, const Direction& n) { return {-n.z, n.x, n.y, portable::atan2(n.x, -n.z)}; }

LatlongGrid::Row LatlongGrid::row(int row, int /*order*/) const {
  Row made{this};
  const quadrature::Rule<3>& gauss = quadrature::rule<3>();
  for (std::size_t k = 0; k < 3; ++k) {
    const double angle = (row + 0.5 + 0.5 * gauss.node[k]) / height_, weight = 0.5 * pi / height_ * gauss.weight[k];
    const double sine = portable::sin_pi(angle), cosine = portable::cos_pi(angle), w = weight * sine;
    made.o += w, made.c += w * cosine, made.s += w * sine;
    made.cc += w * cosine * cosine, made.cs += w * cosine * sine, made.ss += w * sine * sine;
    made.ssc += w * sine * sine * cosine, made.sss += w * sine * sine * sine;
  }
  return made;
}

void LatlongGrid::Row::add(std::span<const Colour> texels, int first, int order, BlockMoments& block) const {
  Flux uniform(0), x(0), y(0), xx(0), xy(0), xxx(0), xxy(0);
  for (std::size_t i = 0; i < texels.size(); ++i) {
    const std::array<double, 6>& a = grid->across_[std::size_t(first) + i];
    const Flux light(texels[i]);
    block.least = glm::min(block.least, texels[i]);
    uniform += light, x += a[0] * light, y += a[1] * light;
    if (order > 1) xx += a[2] * light, xy += a[3] * light;
    if (order > 2) xxx += a[4] * light, xxy += a[5] * light;
  }
  uniform *= 2 * pi / grid->width_;
  const auto put = [&](std::size_t m, const Flux& f) {
    for (std::size_t k = 0; k < 3; ++k) block.moments[m][k] += f[int(k)];
  };
  put(0, o * uniform), put(1, s * x), put(2, s * y), put(3, c * uniform);
  if (order > 1)
    put(4, ss * xx), put(5, ss * (uniform - xx)), put(6, cc * uniform), put(7, ss * xy), put(8, cs * x), put(9, cs * y);
  if (order > 2)
    put(10, sss * xxx), put(11, sss * xxy), put(12, ssc * xx), put(13, sss * (x - xxx)), put(14, ssc * xy),
        put(15, sss * (y - xxy)), put(16, ssc * (uniform - xx));
}

namespace {

// The shape of the cells of a row. @param top,bottom polar angles over pi. @param pole 1 or -1 where the row touches
// one.
CellShape row_shape(double top, double bottom, int pole) {
  const double s0 = portable::sin_pi(top), s1 = portable::sin_pi(bottom), c0 = portable::cos_pi(top),
               c1 = portable::cos_pi(bottom);
  const double middle = 0.5 * (top + bottom), size = bottom - top;
  CellShape shape;
  const double sine = portable::sin_pi(middle);
  shape.solid_angle = 2 * sine * portable::sin_pi(0.5 * size);
  shape.mean[2] = 0.5 * portable::sin_pi(2 * middle) * portable::sin_pi(size) / shape.solid_angle;
  shape.mean[0] = quadrature::line<5>(top, bottom, [](double a) { return portable::sin_pi(a) * portable::sin_pi(a); }) *
                  pi / shape.solid_angle;
  if (pole != 0) {
    shape.polar = true;
    shape.centre = 0.5 * (c0 + c1), shape.half = 0.5 * (c0 - c1);
    shape.far = std::max(s0, s1);
    return shape;
  }
  const bool across_equator = top < 0.5 && bottom > 0.5;
  shape.near = across_equator ? 1 : std::max(s0, s1);
  shape.far = std::min(s0, s1);
  shape.centre = 0.5 * (cot(s0, c0) + cot(s1, c1));
  shape.half = 0.5 * portable::sin_pi(size) / (s0 * s1);
  const double r = 1 / std::sqrt(1 + shape.centre * shape.centre);
  shape.weight1 = 2 * shape.half * power(r, 4) / shape.solid_angle;
  shape.weight2 = 2 * shape.half * power(r, 5) / shape.solid_angle;
  shape.variation1 = variation(shape.near / r, shape.far / r, 4),
  shape.variation2 = variation(shape.near / r, shape.far / r, 5);
  return shape;
}

}  // namespace

LatlongGrid::Cells LatlongGrid::cells(int side) const {
  Cells made{{width_, side}, {height_, side}, {}, {}, {}};
  const double h = height_, w = width_;
  for (int k = 0; k < made.across.count(); ++k) {
    // Longitudes over pi.
    const double middle = (made.across.first(k) + made.across.end(k)) / w,
                 half = (made.across.end(k) - made.across.first(k)) / w;
    const double sine = portable::sin_pi(half), cosine = portable::cos_pi(half), angle = pi * half;
    // Over the column cos is within (1 - cosine) / 2 of (1 + cosine) / 2, and sin within 0.07 angle^3 of the line to
    // its ends.
    made.columns.push_back({portable::cos_pi(middle), portable::sin_pi(middle), 0.5 * (1 + cosine), sine,
                            0.5 * (1 - cosine), 0.07 * angle * angle * angle, sine / angle, 2 * angle});
  }
  const int rows = made.down.count();
  for (int k = 0; k < rows; ++k)
    made.rows.push_back(row_shape(made.down.first(k) / h, made.down.end(k) / h, k == 0 ? 1 : k == rows - 1 ? -1 : 0));
  for (int k = 0; k <= rows; ++k) {
    const double border = k == 0 ? 0 : made.down.end(k - 1) / h;
    made.slopes.push_back(k == 0 ? 1e9 : k == rows ? -1e9 : cot(portable::sin_pi(border), portable::cos_pi(border)));
  }
  return made;
}

RowSpan LatlongGrid::Cells::span(const FaceDirection& n, const double* angles, int row) const {
  const int count = across.count();
  // Longitudes within `inner` of n's have both borders of the row above the horizon, those within `outer` one or both.
  const double inner = std::min(angles[row], angles[row + 1]), outer = std::max(angles[row], angles[row + 1]);
  if (outer <= 0) return {0, 0, 0, 0};
  if (inner >= pi) return {0, 0, count, count};
  constexpr double margin = 1e-12;  // Of rounding errors.
  // Columns are counted on copies of the row side by side, two turns on, so that none is negative.
  const double middle = n.longitude + 4 * pi;
  const auto column = [&](double longitude) {
    const double turns = longitude / (2 * pi);
    const int whole = int(turns);
    return whole * count + std::min(int((turns - whole) * across.texels) / across.side, count - 1);
  };
  RowSpan s{column(middle - outer - margin), column(middle - inner + margin) + 1, column(middle + inner - margin),
            column(middle + outer + margin) + 1};
  if (s.first >= s.last) {  // No cell is wholly above: all may be cut, each once.
    s.end = std::min(s.end, s.cut + count);
    s.first = s.last = s.end;
  } else if (s.end - s.cut >= count) {  // The cut cells of both sides meet behind n.
    s.cut = s.first, s.end = s.first + count;
  }
  const int turned = s.cut / count * count;
  return {s.cut - turned, s.first - turned, s.last - turned, s.end - turned};
}

LatlongGrid::Part LatlongGrid::texel(const FaceDirection& n, int row, int column) const {
  const auto [cosine, sine] = rows_[std::size_t(row)];
  const auto [c, s] = columns_[std::size_t(column)];
  return {this, sine, cosine, n.x * c + n.y * s, n.x * s - n.y * c, 0, 0, row == 0 ? 1 : row == height_ - 1 ? -1 : 0};
}

PartView LatlongGrid::Part::view(const FaceDirection& n) const {
  const Halving &h = grid->halvings_[std::size_t(down)], &a = grid->halvings_[std::size_t(across)];
  const double half_height = 0.5 * pi / std::ldexp(double(grid->height_), down);
  const double once = 2 * level * a.sine_across, twice = a.sine_across * a.cosine_across;
  // Integrals over the columns of the square and the cube of `level` cos + `turn` sin.
  const double squares = level * level * (a.across + twice) + turn * turn * (a.across - twice);
  const double sine_cubed = a.sine_across * a.sine_across * a.sine_across;
  const double cubes = level * level * once + 2.0 / 3 * sine_cubed * level * (3 * turn * turn - level * level);
  PartView v{};
  for (int k = -1; k <= 1; ++k) {
    const double weight = half_height * quadrature::gauss_3.weight[std::size_t(k + 1)], sn = k * h.sine_node,
                 cn = k == 0 ? 1 : h.cosine_node;
    const double s = sine * cn + cosine * sn, c = cosine * cn - sine * sn, height = n.z * c;
    v.solid_angle += weight * s * 2 * a.across;
    v.first += weight * s * (height * 2 * a.across + s * once);
    v.second += weight * s * (height * height * 2 * a.across + 2 * height * s * once + s * s * squares);
    v.third += weight * s *
               (height * height * (height * 2 * a.across + 3 * s * once) + s * s * (3 * height * squares + s * cubes));
  }
  const double s0 = sine * h.cosine_down - cosine * h.sine_down, s1 = sine * h.cosine_down + cosine * h.sine_down;
  const double c0 = cosine * h.cosine_down + sine * h.sine_down, c1 = cosine * h.cosine_down - sine * h.sine_down;
  if (pole != 0) {
    CellView t{};
    set_polar(t, n.z, 0.5 * (c0 + c1), 0.5 * (c0 - c1), level, turn, a.sine_across, a.cosine_across, std::max(s0, s1));
    v.middle = t.middle, v.across = t.across, v.down = t.down, v.polar = true;
    return v;
  }
  const double y = 0.5 * (cot(s0, c0) + cot(s1, c1)), half = h.sine_down * h.cosine_down / (s0 * s1),
               r = 1 / std::sqrt(1 + y * y);
  v.middle = n.z * y + 0.5 * level * (1 + a.cosine_across);
  v.across = std::abs(turn) * a.sine_across, v.down = std::abs(n.z) * half;
  v.bend = std::abs(level) * 0.5 * (1 - a.cosine_across) + std::abs(turn) * 0.07 * a.across * a.across * a.across;
  const double area = 4 * half * a.across, most = c0 > 0 && c1 < 0 ? 1 : std::max(s0, s1), up = most / r,
               low = std::min(s0, s1) / r;
  v.weight1 = area * r * r * r * r, v.variation1 = variation(up, low, 4);
  v.weight2 = v.weight1 * r, v.variation2 = variation(up, low, 5);
  return v;
}

// The part that touches a pole keeps its longitudes, so that there is only one of it at each depth.
Division<LatlongGrid::Part> LatlongGrid::Part::divided() const {
  const Halving &d = grid->halvings_[std::size_t(down) + 1], &a = grid->halvings_[std::size_t(across) + 1];
  Division<Part> made{};
  for (int k = 0; k < 2; ++k) {
    const double sn = k == 0 ? -d.sine_down : d.sine_down;
    const double s = sine * d.cosine_down + cosine * sn, c = cosine * d.cosine_down - sine * sn;
    if (pole == (k == 0 ? 1 : -1)) {
      made.parts[made.count++] = {grid, s, c, level, turn, down + 1, across, pole};
      continue;
    }
    for (const double sa : {-a.sine_across, a.sine_across})
      made.parts[made.count++] = {
          grid,     s,          c, level * a.cosine_across - turn * sa, turn * a.cosine_across + level * sa,
          down + 1, across + 1, 0};
  }
  return made;
}

}  // namespace envmap::prefiltering
