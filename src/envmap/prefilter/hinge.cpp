#include "envmap/prefilter/hinge.h"

#include <algorithm>
#include <variant>

#include "envmap/prefilter/cell.h"
#include "envmap/prefilter/hinge_kernels.h"

namespace envmap::prefiltering {

namespace {

using Channels = std::array<double, 3>;

// Terms added up, by order and channel.
struct Total {
  std::array<Channels, 2> sum{}, off{};

  void add(const HingeTerm& t, int order) {
    for (std::size_t c = 0; c < 3; ++c) sum[0][c] += double(t.middle1[c]), off[0][c] += double(t.off1[c]);
    if (order == 1) return;
    for (std::size_t c = 0; c < 3; ++c) sum[1][c] += double(t.middle2[c]), off[1][c] += double(t.off2[c]);
  }
  void add(const Total& t) {
    for (std::size_t k = 0; k < 2; ++k)
      for (std::size_t c = 0; c < 3; ++c) sum[k][c] += t.sum[k][c], off[k][c] += t.off[k][c];
  }
};

// Integrals of t+ and t+^2 over the half sphere: 0.001 of them is what sums are held to at least.
constexpr std::array<double, 2> whole{pi, 2 * pi / 3};
constexpr double floor_of_mean = 1e-3;

// Part of a flux that Gauss points, sums in double and the borders of cells may be off by.
constexpr double numerical = 1e-11;

// Means over a rectangle of a plane, by differences over its corners.
struct Plane {
  double size, square, signed_square;  // Of |p|, p^2 and p |p|.
  Plane(double middle, double across, double down) {
    const double least = 1e-4 * std::max(across, down) + 1e-300;
    const double a = std::max(across, least), b = std::max(down, least);
    const double corners[] = {middle + a + b, middle + a - b, middle - a + b, middle - a - b};
    double cubes = 0, fourths = 0;
    for (int k = 0; k < 4; ++k) {
      const double q = corners[k], cube = std::abs(q) * q * q, sign = k == 0 || k == 3 ? 1 : -1;
      cubes += sign * cube, fourths += sign * cube * q;
    }
    size = cubes / (24 * a * b), signed_square = fourths / (48 * a * b);
    square = middle * middle + (a * a + b * b) / 3;
  }
};

// What a part of a texel of radiance 1 adds, and how far that may be off.
struct PartTerm {
  std::array<double, 2> sum, off;
};
PartTerm cut_part(const PartView& v, double extent) {
  const double top = v.middle + extent;
  if (v.polar) {  // Between Jensen's inequality and the chord.
    const double bottom = v.middle - extent, least = std::max(0.0, v.first);
    const double most = std::max(least, (v.first - v.solid_angle * bottom) * top / (top - bottom));
    return {{0.5 * (least + most), 0.5 * top * most}, {0.5 * (most - least), 0.5 * top * most}};
  }
  const Plane plane(v.middle, v.across, v.down);
  const double bend = v.bend + 1e-8 * std::max(v.across, v.down);
  return {{0.5 * (v.first + v.weight1 * plane.size), 0.5 * (v.second + v.weight2 * plane.signed_square)},
          {0.5 * v.weight1 * (v.uneven1 * plane.size + (1 + v.uneven1) * bend),
           0.5 * v.weight2 * (v.uneven2 * plane.square + (1 + v.uneven2) * bend * 2 * (std::abs(v.middle) + extent))}};
}

// One direction's sum in the making.
template <class Grid>
class Summation {
 public:
  Summation(const HingeSource<Grid>& source, double error, const std::array<double, 2>& least)
      : source_(source), error_(error), least_(least), order_(source.order()) {}

  HingeSums over(const Direction& n) {
    for (int face = 0; face < Grid::faces; ++face) seen_[std::size_t(face)] = Grid::seen(face, n);
    settled_ = {}, terms_.clear();
    for (std::size_t k = 0; k < 2; ++k)
      for (int c = 0; c < 3; ++c) settled_.sum[k][std::size_t(c)] = whole[k] * source_.darkest()[c];
    // The flux of a channel is 12 pi times the mean at most.
    for (Channels& off : settled_.off) off.fill(numerical * 12 * pi);
    for (int face = 0; face < Grid::faces; ++face) add_face(face);
    refine();
    HingeSums out;
    for (std::size_t k = 0; k < 2; ++k)
      for (int c = 0; c < 3; ++c)
        out.sum[k][c] = settled_.sum[k][std::size_t(c)], out.bound[k][c] = settled_.off[k][std::size_t(c)];
    return out;
  }

 private:
  // Rows of base cells: what is wholly above by prefix sums, and terms of what is cut.
  void add_face(int face) {
    const auto& cells = source_.base();
    const auto& grid = cells.grid;
    const FaceDirection& n = seen_[std::size_t(face)];
    if (!grid.slopes.empty())
      border_angles(n.z / std::max(1e-9, std::sqrt(n.x * n.x + n.y * n.y)), grid.slopes, angles_);
    batch_.clear();
    spans_.clear();
    for (int row = 0; row < grid.down.count(); ++row) {
      const RowSpan span = grid.span(n, angles_.data(), row);
      spans_.push_back(span);
      if (span.last > span.first) source_.prefetch(face, row, span.first, span.last);
      const auto add = [&](int from, int to) {
        for (int k = from; k < to; ++k) add_cell(cells, n, face, row, grid.wrapped(k));
      };
      add(span.cut, std::min(span.first, span.end)), add(span.last, span.end);
    }
    typename HingeSource<Grid>::Sums sums{};
    for (int row = 0; row < grid.down.count(); ++row)
      if (const RowSpan& span = spans_[std::size_t(row)]; span.last > span.first)
        source_.add(face, row, span.first, span.last, sums);
    bound_cells(n, batch_, order_, terms_);
    for (std::size_t c = 0; c < 3; ++c) {
      const auto m = [&](std::size_t k) { return sums[3 * k + c]; };
      settled_.sum[0][c] += m(0) * n.x + m(1) * n.y + m(2) * n.z;
      if (order_ > 1)
        settled_.sum[1][c] += m(3) * (n.x * n.x) + m(4) * (n.y * n.y) + m(5) * (n.z * n.z) +
                              2 * (m(6) * (n.x * n.y) + m(7) * (n.x * n.z) + m(8) * (n.y * n.z));
    }
  }

  void add_cell(const typename HingeSource<Grid>::Cells& cells, const FaceDirection& n, int face, int row, int column) {
    const HingeCell& cell = cells.cell(face, row, column);
    __builtin_prefetch(&cell);
    batch_.add(cells.grid.view(n, row, column), cells.grid.shape(row, column), cells.grid.solid_angle(row, column),
               {&cell, face, row, column});
  }

  // What each sum may be off by: by order and channel.
  [[nodiscard]] std::array<Channels, 2> allowed(const Total& now) const {
    std::array<Channels, 2> all;
    for (std::size_t k = 0; k < 2; ++k)
      for (std::size_t c = 0; c < 3; ++c)
        all[k][c] = error_ * std::max({now.sum[k][c] - now.off[k][c], floor_of_mean * whole[k], least_[k]});
    return all;
  }
  [[nodiscard]] bool within(const Total& now, const std::array<Channels, 2>& most, double part) const {
    for (std::size_t k = 0; k < std::size_t(order_); ++k)
      for (std::size_t c = 0; c < 3; ++c)
        if (now.off[k][c] > part * most[k][c]) return false;
    return true;
  }

  // Divides the terms that are off by most, level by level, until all together are good enough.
  void refine() {
    double share = 0.5;
    for (std::size_t level = source_.levels().size(); level-- > 0; share *= 0.6) {
      Total now = settled_;
      for (const HingeTerm& t : terms_) now.add(t, order_);
      const std::array<Channels, 2> most = allowed(now);
      if (within(now, most, 1)) break;
      divide(level, now, most, share / double(std::max<std::size_t>(1, terms_.size())));
    }
    for (const HingeTerm& t : terms_) settled_.add(t, order_);
    terms_.clear();
  }

  // @param now the sum of all, to stop as soon as that is good enough. @param share of what is allowed, of one term.
  void divide(std::size_t level, Total now, const std::array<Channels, 2>& most, double share) {
    next_.clear();
    bool enough = false;
    for (const HingeTerm& t : terms_) {
      enough = enough || within(now, most, 0.99);
      if (enough || is_fine(t, most, share)) {
        settled_.add(t, order_);
        continue;
      }
      const std::size_t first = next_.size();
      if (level > 0)
        add_quarters(level - 1, t);
      else
        add_texels(t, most, 0.02 * share);
      for (std::size_t c = 0; c < 3; ++c) {
        now.off[0][c] -= double(t.off1[c]);
        if (order_ > 1) now.off[1][c] -= double(t.off2[c]);
      }
      for (std::size_t k = first; k < next_.size(); ++k) now.add(next_[k], order_);
    }
    std::swap(terms_, next_);
  }
  [[nodiscard]] bool is_fine(const HingeTerm& t, const std::array<Channels, 2>& most, double share) const {
    for (std::size_t c = 0; c < 3; ++c)
      if (double(t.off1[c]) > share * most[0][c] || (order_ > 1 && double(t.off2[c]) > share * most[1][c]))
        return false;
    return true;
  }

  void add_quarters(std::size_t level, const HingeTerm& t) {
    const auto& cells = source_.levels()[level];
    const auto& grid = cells.grid;
    const FaceDirection& n = seen_[std::size_t(t.face)];
    batch_.clear();
    for (int row = 2 * t.row; row < std::min(2 * t.row + 2, grid.down.count()); ++row)
      for (int column = 2 * t.column; column < std::min(2 * t.column + 2, grid.across.count()); ++column)
        add_cell(cells, n, t.face, row, column);
    bound_cells(n, batch_, order_, next_);
  }

  void add_texels(const HingeTerm& t, const std::array<Channels, 2>& most, double share) {
    const auto& grid = source_.levels().front().grid;
    const FaceDirection& n = seen_[std::size_t(t.face)];
    for (int row = grid.down.first(t.row); row < grid.down.end(t.row); ++row)
      for (int column = grid.across.first(t.column); column < grid.across.end(t.column); ++column) {
        const Flux radiance = source_.radiance(t.face, row, column);
        if (radiance != Flux(0)) add_part(source_.grid().texel(n, row, column), n, radiance, most, share, 0);
      }
  }

  template <class Part>
  void add_part(const Part& part, const FaceDirection& n, const Flux& radiance, const std::array<Channels, 2>& most,
                double share, int depth) {
    const PartView v = part.view(n);
    const double extent = v.across + v.down + v.bend;
    if (v.middle <= -extent) return;
    const bool cut = v.middle < extent;
    const PartTerm term = cut ? cut_part(v, extent) : PartTerm{{v.first, v.second}, {0, 0}};
    bool fine = true;
    for (std::size_t k = 0; k < std::size_t(order_); ++k)
      for (int c = 0; c < 3; ++c) fine = fine && term.off[k] * radiance[c] <= share * most[k][std::size_t(c)];
    constexpr int deepest = 12;
    if (!fine && depth < deepest) {
      const Division<Part> smaller = part.divided();
      for (std::size_t k = 0; k < smaller.count; ++k) add_part(smaller.parts[k], n, radiance, most, share, depth + 1);
      return;
    }
    for (std::size_t k = 0; k < 2; ++k)
      for (int c = 0; c < 3; ++c) {
        settled_.sum[k][std::size_t(c)] += term.sum[k] * radiance[c];
        settled_.off[k][std::size_t(c)] += (term.off[k] + numerical * v.solid_angle) * radiance[c];
      }
  }

  const HingeSource<Grid>& source_;
  double error_;
  std::array<double, 2> least_;
  int order_;
  std::array<FaceDirection, Grid::faces> seen_;
  Total settled_;
  HingeBatch batch_;
  std::vector<HingeTerm> terms_, next_;
  std::vector<double> angles_;
  std::vector<RowSpan> spans_;
};

template <class Grid>
void sum_all(const HingeSource<Grid>& source, std::span<const Direction> directions, double error,
             const std::array<double, 2>& least, double mean, std::span<HingeSums> out) {
  Summation<Grid> summation(source, error, least);
  for (std::size_t k = 0; k < directions.size(); ++k) {
    out[k] = summation.over(directions[k]);
    for (auto* fluxes : {&out[k].sum, &out[k].bound})
      for (Flux& f : *fluxes) f *= mean;
  }
}

// Rows of cells from pole to pole that sums start from.
int base_rows(double error) { return error < 3e-4 ? 128 : 64; }

}  // namespace

struct Hinges::Prepared {
  std::variant<HingeSource<LatlongGrid>, HingeSource<CubeGrid>> source;
  double mean;
  int order, rows;
};

Hinges::Hinges(const Level& source, double mean, int order, double error) {
  const int rows = base_rows(error);
  if (source.projection() == Projection::latlong)
    prepared_ =
        std::make_unique<Prepared>(Prepared{HingeSource<LatlongGrid>(source, mean, rows, order), mean, order, rows});
  else
    prepared_ =
        std::make_unique<Prepared>(Prepared{HingeSource<CubeGrid>(source, mean, rows / 2, order), mean, order, rows});
}
Hinges::~Hinges() = default;
Hinges::Hinges(Hinges&&) noexcept = default;

bool Hinges::fits(int order, double error) const {
  return prepared_->order >= order && prepared_->rows == base_rows(error);
}

void Hinges::sums(std::span<const Direction> directions, double error, std::span<HingeSums> out,
                  const std::array<double, 2>& least) const {
  std::visit([&](const auto& source) { sum_all(source, directions, error, least, prepared_->mean, out); },
             prepared_->source);
}

std::optional<std::array<double, 2>> hinge_factors(const Lobe& lobe) {
  if (const auto* cosine = std::get_if<Cosine>(&lobe)) return std::array{cosine->value(0), 0.0};
  if (const auto* ggx = std::get_if<Ggx>(&lobe); ggx && ggx->b == 0) return std::array{ggx->value(0), 0.0};
  if (const auto* phong = std::get_if<Phong>(&lobe); phong && phong->exponent == 2)
    return std::array{0.0, phong->scale()};
  return std::nullopt;
}

}  // namespace envmap::prefiltering
