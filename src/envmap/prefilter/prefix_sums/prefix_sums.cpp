// One sum: cells above the horizon by prefix sums, cut cells by upper and lower limits, and division of the cells with
// the largest gaps until the bound is small enough. docs/explanation/prefilter-horizon.md proves the bound.
#include "envmap/prefilter/prefix_sums/prefix_sums.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <variant>

#include "envmap/prefilter/cell_moments.h"
#include "envmap/prefilter/error_floor.h"
#include "envmap/prefilter/prefix_sums/prefix_kernels.h"
#include "envmap/prefilter/work_counters.h"

namespace envmap::prefiltering {

namespace {

Flux flux_of(const float (&lanes)[4]) { return {lanes[0], lanes[1], lanes[2]}; }

// A sum and its bound.
struct Total {
  Flux sum{0}, error{0};

  void add(const CellTerm& t) { sum += flux_of(t.middle), error += flux_of(t.error); }
};

bool within(const Flux& error, const Flux& most) { return !glm::any(glm::greaterThan(error, most)); }

// Error of Gauss points, of sums in double and of the borders of cells, as a part of a flux.
constexpr double numerical = 1e-11;

// Means over a rectangle of |p|, p^2 and p |p| of a plane p, by differences over the corners.
struct Plane {
  double size, square, signed_square;
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

// The integral of the weight over a part of a texel, and the bound of its error.
struct PartTerm {
  double sum, error;
};
PartTerm whole_part(const PartView& v, const ClampedCosinePolynomial& weight) {
  return {weight.factors[0] * v.first + weight.factors[1] * v.second + weight.factors[2] * v.third, 0};
}
PartTerm cut_part(const PartView& v, double extent, const ClampedCosinePolynomial& weight) {
  const double top = v.middle + extent;
  if (v.polar) {  // Between Jensen's inequality and the chord.
    const double bottom = v.middle - extent, jensen = std::max(0.0, v.first);
    const double chord = std::max(jensen, (v.first - v.solid_angle * bottom) * top / (top - bottom));
    const double least = weight.factors[0] * jensen, most = weight.slope(top) * chord;
    return {0.5 * (least + most), 0.5 * (most - least)};
  }
  const Plane plane(v.middle, v.across, v.down);
  const double bend = v.bend + 1e-8 * std::max(v.across, v.down);
  const double first = 0.5 * (v.first + v.weight1 * plane.size),
               error1 = 0.5 * v.weight1 * (v.variation1 * plane.size + (1 + v.variation1) * bend);
  const double second = 0.5 * (v.second + v.weight2 * plane.signed_square),
               error2 = 0.5 * v.weight2 *
                        (v.variation2 * plane.square + (1 + v.variation2) * bend * 2 * (std::abs(v.middle) + extent));
  const double third = 0.5 * weight.factors[2] * top * (second + error2);  // The middle of 0 and the most.
  return {weight.factors[0] * first + weight.factors[1] * second + third,
          weight.factors[0] * error1 + weight.factors[1] * error2 + third};
}

// The integral of the weight as a sum of factor x moment, over the moments x, y, z, xx, yy, zz, xy, xz, yz, xxx, xxy,
// xxz, xyy, xyz, yyy, yyz. The other three follow from x^2 + y^2 + z^2 = 1: xzz = x - xxx - xyy, and so on.
std::array<double, moment_counts.back() - 1> moment_factors(const ClampedCosinePolynomial& weight,
                                                            const FaceDirection& n) {
  const auto [a, b, c] = weight.factors;
  const double x = n.x, y = n.y, z = n.z, zz = 3 * c * z * z;
  return {x * (a + zz),
          y * (a + zz),
          z * (a + c * z * z),
          b * x * x,
          b * y * y,
          b * z * z,
          2 * b * x * y,
          2 * b * x * z,
          2 * b * y * z,
          x * (c * x * x - zz),
          y * (3 * c * x * x - zz),
          z * c * (3 * x * x - z * z),
          x * (3 * c * y * y - zz),
          6 * c * x * y * z,
          y * (c * y * y - zz),
          z * c * (3 * y * y - z * z)};
}

// Sums one direction after the other.
template <class Grid>
class HorizonSummation {
 public:
  HorizonSummation(const PrefixSumSource<Grid>& source, const ClampedCosinePolynomial& weight, double error)
      : source_(source), weight_(weight), error_(error) {}

  // @param beside in units of the mean.
  PrefixSum over(const Direction& n, const Flux& beside) {
    beside_ = beside;
    start_ = start();
    for (int face = 0; face < Grid::faces; ++face) seen_[std::size_t(face)] = Grid::seen(face, n);
    accepted_ = {}, terms_.clear();
    accepted_.sum = weight_.integral() * Flux(source_.min_radiance());
    accepted_.error = Flux(numerical * most_flux * weight_.slope(1));
    for (int face = 0; face < Grid::faces; ++face) add_face(face);
    refine();
    return {accepted_.sum, accepted_.error};
  }

 private:
  // The coarsest cells whose gaps are small enough under uniform light. Along the horizon the cells have a solid angle
  // of 2 pi x their side, and their mean gap is a sixteenth of their side.
  [[nodiscard]] std::size_t start() const {
    const double most = error_ * std::max(std::min({beside_.x, beside_.y, beside_.z}), floor_of_mean);
    for (std::size_t level = source_.levels().size(); --level > source_.base();) {
      const double side = source_.side(level);
      if (0.4 * side * side * weight_.slope(1) <= most) return level;
    }
    return source_.base();
  }

  // Adds the rows of cells of a face: cells wholly above the horizon by prefix sums, cut cells as terms.
  void add_face(int face) {
    const auto& cells = source_.levels()[start_];
    const auto& grid = cells.grid;
    const FaceDirection& n = seen_[std::size_t(face)];
    if (!grid.slopes.empty())
      border_angles(n.z / std::max(1e-9, std::sqrt(n.x * n.x + n.y * n.y)), grid.slopes, angles_);
    batch_.clear();
    spans_.clear();
    for (int row = 0; row < grid.down.count(); ++row) {
      const RowSpan span = grid.span(n, angles_.data(), row);
      spans_.push_back(span);
      if (span.last > span.first) source_.prefetch(start_, face, row, span.first, span.last);
      const auto add = [&](int from, int to) {
        for (int k = from; k < to; ++k) add_cell(cells, n, face, row, grid.wrapped(k));
      };
      add(span.cut, std::min(span.first, span.end)), add(span.last, span.end);
    }
    typename PrefixSumSource<Grid>::Sums sums{};
    for (int row = 0; row < grid.down.count(); ++row)
      if (const RowSpan& span = spans_[std::size_t(row)]; span.last > span.first)
        source_.add(start_, face, row, span.first, span.last, sums);
    count(Work::horizon_rows, spans_.size());
    count(Work::horizon_cells, batch_.count());
    bound_cells(n, weight_, batch_, terms_);
    const auto factors = moment_factors(weight_, n);
    const std::size_t moments = moment_counts[std::size_t(source_.order())] - 1;
    for (std::size_t m = 0; m < moments; ++m)
      for (std::size_t c = 0; c < 3; ++c) accepted_.sum[c] += factors[m] * sums[3 * m + c];
  }

  void add_cell(const typename PrefixSumSource<Grid>::Cells& cells, const FaceDirection& n, int face, int row,
                int column) {
    const CellLight& cell = cells.cell(face, row, column);
    __builtin_prefetch(&cell);
    batch_.add(cells.grid.view(n, row, column), cells.grid.shape(row, column), cells.grid.solid_angle(row, column),
               {&cell, face, row, column});
  }

  // The error that each channel may have.
  [[nodiscard]] Flux allowed(const Total& now) const {
    return error_ * glm::max(now.sum - now.error + beside_, floor_of_mean);
  }

  // Divides the terms of the largest errors, level by level, until the sum of all errors is small enough.
  void refine() {
    double share = 0.5;
    for (std::size_t level = start_ + 1; level-- > 0; share *= 0.5) {
      Total now = accepted_;
      for (const CellTerm& t : terms_) now.add(t);
      const Flux most = allowed(now);
      if (within(now.error, most)) break;
      divide(level, now, most, share / double(std::max<std::size_t>(1, terms_.size())));
    }
    for (const CellTerm& t : terms_) accepted_.add(t);
    terms_.clear();
  }

  // @param now the sum of all terms: division ends once its error is small enough. @param share of the allowed error
  // that one term may have.
  void divide(std::size_t level, Total now, const Flux& most, double share) {
    next_.clear();
    bool enough = false;
    for (const CellTerm& t : terms_) {
      enough = enough || within(now.error, 0.99 * most);
      if (enough || within(flux_of(t.error), share * most)) {
        accepted_.add(t);
        continue;
      }
      const std::size_t first = next_.size();
      if (level > 0)
        add_quarters(level - 1, t);
      else
        add_texels(t, most, 0.02 * share);
      now.error -= flux_of(t.error);
      for (std::size_t k = first; k < next_.size(); ++k) now.add(next_[k]);
    }
    std::swap(terms_, next_);
  }

  void add_quarters(std::size_t level, const CellTerm& t) {
    const auto& cells = source_.levels()[level];
    const auto& grid = cells.grid;
    const FaceDirection& n = seen_[std::size_t(t.face)];
    batch_.clear();
    for (int row = 2 * t.row; row < std::min(2 * t.row + 2, grid.down.count()); ++row)
      for (int column = 2 * t.column; column < std::min(2 * t.column + 2, grid.across.count()); ++column)
        add_cell(cells, n, t.face, row, column);
    count(Work::horizon_cells, batch_.count());
    bound_cells(n, weight_, batch_, next_);
  }

  void add_texels(const CellTerm& t, const Flux& most, double share) {
    const auto& grid = source_.levels().front().grid;
    const FaceDirection& n = seen_[std::size_t(t.face)];
    for (int row = grid.down.first(t.row); row < grid.down.end(t.row); ++row)
      for (int column = grid.across.first(t.column); column < grid.across.end(t.column); ++column) {
        const Flux radiance = source_.radiance(t.face, row, column);
        if (radiance != Flux(0)) add_part(source_.grid().texel(n, row, column), n, radiance, most, share, 0);
      }
  }

  template <class Part>
  void add_part(const Part& part, const FaceDirection& n, const Flux& radiance, const Flux& most, double share,
                int depth) {
    const PartView v = part.view(n);
    const double extent = v.across + v.down + v.bend;
    if (v.middle <= -extent) return;
    const bool cut = v.middle < extent;
    count(Work::horizon_parts, 1);
    const PartTerm term = cut ? cut_part(v, extent, weight_) : whole_part(v, weight_);
    constexpr int deepest = 12;
    if (depth < deepest && !within(term.error * radiance, share * most)) {
      const Division<Part> smaller = part.divided();
      for (std::size_t k = 0; k < smaller.count; ++k) add_part(smaller.parts[k], n, radiance, most, share, depth + 1);
      return;
    }
    const double rounding_of_part = numerical * v.solid_angle * weight_.slope(1);
    accepted_.sum += term.sum * radiance, accepted_.error += (term.error + rounding_of_part) * radiance;
  }

  const PrefixSumSource<Grid>& source_;
  ClampedCosinePolynomial weight_;
  double error_;
  Flux beside_{0};
  std::size_t start_ = 0;  // The level of cells that the sum starts from.
  std::array<FaceDirection, Grid::faces> seen_;
  Total accepted_;
  CellBatch batch_;
  std::vector<CellTerm> terms_, next_;
  std::vector<double> angles_;
  std::vector<RowSpan> spans_;
};

template <class Grid>
void sum_all(const PrefixSumSource<Grid>& source, const ClampedCosinePolynomial& weight,
             std::span<const Direction> directions, double error, double mean, std::span<const Flux> beside,
             std::span<PrefixSum> out) {
  HorizonSummation<Grid> summation(source, weight, error);
  for (std::size_t k = 0; k < directions.size(); ++k) {
    const PrefixSum sum = summation.over(directions[k], beside.empty() ? Flux(0) : beside[k] / mean);
    out[k] = {mean * sum.value, mean * sum.bound};
    source.trim();
  }
}

// The least and the largest number of rows of cells, from pole to pole, that sums start from.
constexpr int fewest_rows = 8;
int base_rows(double error) { return error < 3e-4 ? 128 : 64; }

constexpr double rounding = 0x1p-24;  // Relative rounding of a float.

// Sets one texel. @return its bound.
float set_texel(const PrefixSum& sum, double floor, Colour& out) {
  if (const Flux s = sum.value + sum.bound; !std::isfinite(s.x + s.y + s.z))
    return std::numeric_limits<float>::infinity();  // prefilter.cpp sums the texel exactly.
  double largest = 0;
  for (int c = 0; c < 3; ++c) {
    largest = std::max(largest, sum.bound[c] / std::max(sum.value[c] - sum.bound[c], floor));
    out[c] = float(std::max(0.0, sum.value[c]));
  }
  // Two roundings: of the source less its least radiance, and of the result.
  return std::nextafter(float(largest + 2 * rounding), 1.F);
}

}  // namespace

struct PrefixSums::Prepared {
  std::variant<PrefixSumSource<LatlongGrid>, PrefixSumSource<CubeGrid>> source;
  double mean;
  int order, rows;
};

PrefixSums::PrefixSums(const Level& source, double mean, const Colour& min_radiance, int order, double error) {
  const int rows = base_rows(error);
  if (source.projection() == Projection::latlong)
    prepared_ = std::make_unique<Prepared>(
        Prepared{PrefixSumSource<LatlongGrid>(source, mean, min_radiance, rows, fewest_rows, order), mean, order,
                 rows});
  else
    prepared_ = std::make_unique<Prepared>(
        Prepared{PrefixSumSource<CubeGrid>(source, mean, min_radiance, rows / 2, fewest_rows / 2, order), mean, order,
                 rows});
}
PrefixSums::~PrefixSums() = default;

bool PrefixSums::fits(int order, double error) const {
  return prepared_->order >= order && prepared_->rows == base_rows(error);
}

void PrefixSums::sums(const ClampedCosinePolynomial& weight, std::span<const Direction> directions, double error,
                      std::span<const Flux> beside, std::span<PrefixSum> out) const {
  std::visit([&](const auto& source) { sum_all(source, weight, directions, error, prepared_->mean, beside, out); },
             prepared_->source);
}

std::optional<ClampedCosinePolynomial> clamped_cosine_polynomial(const LobeFormula& lobe) {
  if (const auto* cosine = std::get_if<Cosine>(&lobe)) return ClampedCosinePolynomial{{cosine->value(0), 0, 0}};
  if (const auto* ggx = std::get_if<Ggx>(&lobe); ggx && ggx->b == 0)
    return ClampedCosinePolynomial{{ggx->value(0), 0, 0}};
  if (const auto* phong = std::get_if<Phong>(&lobe)) {
    if (phong->exponent == 2) return ClampedCosinePolynomial{{0, phong->scale(), 0}};
    if (phong->exponent == 3) return ClampedCosinePolynomial{{0, 0, phong->scale()}};
  }
  return std::nullopt;
}

ClampedCosinePolynomial blinn_horizon_terms(const BlinnPhong& l) {
  const double first = l.kink(), second = l.power * first, third = 0.5 * (l.power - 1) * second;
  return {{first, second, std::max(0.0, third)}};
}

void prefix_sums_map(const PrefixSums& prefix_sums, const ClampedCosinePolynomial& weight, double max_error,
                     double mean, const TargetTexels& map) {
  const double error = max_error - 3 * rounding;
  map.each_row([&](std::span<const Direction> directions, std::span<Colour> texels, std::span<float> bounds) {
    std::vector<PrefixSum> sums(directions.size());
    prefix_sums.sums(weight, directions, error, {}, sums);
    for (std::size_t k = 0; k < sums.size(); ++k) bounds[k] = set_texel(sums[k], floor_of_mean * mean, texels[k]);
  });
}

}  // namespace envmap::prefiltering
