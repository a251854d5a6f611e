#include "envmap/sample/conservative.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>

#include "envmap/maths/polygon.h"
#include "envmap/sample/area.h"
#include "envmap/sample/sample.h"
#include "envmap/sample/tiles.h"

namespace envmap {
namespace {

constexpr int band_rows = 32;      // Of the source; one task.
constexpr int bands_at_once = 64;  // Fixed, so that sums are added in the same order at any number of threads.
constexpr int deepest = 7;         // Quarterings of a texel: a sun is cut to a 16000th.

// Where a point of the source lies in the result, in texels.
struct Place {
  int face;
  double x, y;
  double density;  // Steradians per du dv of the source.

  [[nodiscard]] int column() const { return static_cast<int>(x); }
  [[nodiscard]] int row() const { return static_cast<int>(y); }
};

// The texels of the result, first and last, that a cell reaches into. Where borders of both images coincide, rounding
// must not make it reach over.
struct Reach {
  int x0, x1, y0, y1;
};

// A part of a source texel: from (u,v), `size` wide and high, with the places of its corners (00, 10, 01, 11).
struct Cell {
  Vec2<double> from, size;
  std::array<Place, 4> corners;
  int depth;

  [[nodiscard]] Reach reach() const {
    const auto& c = corners;
    const auto [x0, x1] = std::minmax({c[0].x, c[1].x, c[2].x, c[3].x});
    const auto [y0, y1] = std::minmax({c[0].y, c[1].y, c[2].y, c[3].y});
    return {static_cast<int>(x0 + 1e-9), static_cast<int>(x1 - 1e-9), static_cast<int>(y0 + 1e-9),
            static_cast<int>(y1 - 1e-9)};
  }
  [[nodiscard]] bool in_one_texel() const {
    const Reach r = reach();
    return on_one_face() && r.x0 == r.x1 && r.y0 == r.y1;
  }
  // One of its inner points, for a cell that lies in one texel.
  [[nodiscard]] Place inside() const {
    const Reach r = reach();
    return {corners[0].face, r.x0 + 0.5, r.y0 + 0.5, 0};
  }
  [[nodiscard]] bool on_one_face() const {
    return corners[0].face == corners[1].face && corners[0].face == corners[2].face && corners[0].face == corners[3].face;
  }
};

// What all bands share.
struct Task {
  const Level& source;
  const Target& target;
  double tolerance, floor;
  int width = target.size * aspect(target.to);  // Of the result.
  double mean_steradians = 4 * pi / (static_cast<double>(faces(target.to)) * width * target.size);
  std::vector<double> steradians = all_solid_angles();  // Of the texels of a face of the result.

  [[nodiscard]] double steradians_at(int column, int row) const {
    return steradians[static_cast<std::size_t>(row) * static_cast<std::size_t>(width) + static_cast<std::size_t>(column)];
  }

 private:
  [[nodiscard]] std::vector<double> all_solid_angles() const {
    std::vector<double> all(static_cast<std::size_t>(width) * static_cast<std::size_t>(target.size));
    tbb::parallel_for(0, target.size, [&](int row) {
      solid_angles(target.to, target.size, row,
                   std::span(all).subspan(static_cast<std::size_t>(row) * static_cast<std::size_t>(width),
                                          static_cast<std::size_t>(width)));
    });
    return all;
  }
};

class Band {
 public:
  explicit Band(const Task& task)
      : task_(task),
        source_(task.source),
        target_(task.target),
        to_result_(glm::transpose(task.target.to_source)),
        width_(task.width),
        height_(task.target.size),
        tiles_(task.width, task.target.size) {}

  void add_row(int face, int row) {
    const Columns in = columns(source_.projection(), source_.height(), row);
    const auto count = static_cast<std::size_t>(in.end - in.first);
    if (row_below_ != row || face_ != face)
      place_corners(face, row, in, above_);
    else
      std::swap(above_, below_);
    place_corners(face, row + 1, in, below_);
    face_ = face;
    row_below_ = on_disc(source_.projection()) ? -1 : row + 1;  // The rows of a disc differ in length.
    smooth(face, row, in);
    points_.clear();
    for (int i = in.first; i < in.end; ++i)
      points_.push_back({(i + 0.5) / source_.width(), (row + 0.5) / source_.height()});
    densities_.resize(count);
    densities(source_.projection(), points_, densities_);
    const double area = 1.0 / source_.width() / source_.height();
    for (std::size_t k = 0; k < count; ++k) {
      const int i = in.first + static_cast<int>(k);
      const Cell cell{{static_cast<double>(i) / source_.width(), static_cast<double>(row) / source_.height()},
                      {1.0 / source_.width(), 1.0 / source_.height()},
                      {above_[k], above_[k + 1], below_[k], below_[k + 1]},
                      0};
      const double slope = std::max(std::abs(above_[k].density - below_[k + 1].density),
                                    std::abs(above_[k + 1].density - below_[k].density));
      const Colour &own = *source_.texel(face, i, row), &near = smooth_[k];
      const bool even =
          slope < task_.tolerance * densities_[k] || glm::all(glm::lessThan(glm::abs(near - own), 0.25F * own));
      if (cell.in_one_texel() && inside_disc(cell) && slope < 0.02 * densities_[k] && even)
        add(cell.inside(), densities_[k] * area, Direction(smooth_[k]));
      else
        part(cell);
    }
  }

  [[nodiscard]] const Tiles& tiles() const { return tiles_; }

 private:
  // Corners of the texels of a row: those above row `row`.
  void place_corners(int face, int row, const Columns& in, std::vector<Place>& out) {
    points_.clear();
    for (int i = in.first; i <= in.end; ++i)
      points_.push_back({static_cast<double>(i) / source_.width(), static_cast<double>(row) / source_.height()});
    out.resize(points_.size());
    place(face, points_, out);
  }

  void place(int face, std::span<const Vec2<double>> points, std::span<Place> out) {
    directions_.resize(points.size());
    locations_.resize(points.size());
    directions(source_.projection(), face, points, directions_);
    rotate(to_result_, directions_);
    locate(target_.to, directions_, locations_);
    place_densities_.resize(points.size());
    densities(source_.projection(), points, place_densities_);
    for (std::size_t k = 0; k < points.size(); ++k)
      out[k] = {locations_[k].face, std::min(locations_[k].u * width_, width_ - 1e-9),
                std::min(locations_[k].v * height_, height_ - 1e-9), place_densities_[k]};
  }

  // The mean of the bilinear reconstruction over whole texels: weights 1 6 1 of 8 each way.
  void smooth(int face, int row, const Columns& in) {
    const auto count = static_cast<std::size_t>(in.end - in.first);
    smooth_.resize(count);
    column_.resize(count + 2);
    const Colour* c = source_.texel(face, in.first - 1, row);
    const std::ptrdiff_t stride = source_.stride();
    for (std::size_t k = 0; k < count + 2; ++k, ++c) column_[k] = 0.125F * (c[-stride] + 6.0F * *c + c[stride]);
    for (std::size_t k = 0; k < count; ++k) smooth_[k] = 0.125F * (column_[k] + 6.0F * column_[k + 1] + column_[k + 2]);
  }

  [[nodiscard]] bool inside_disc(const Cell& cell) const {
    if (!on_disc(source_.projection())) return true;
    const Vec2<double> c = glm::abs(2.0 * cell.from + cell.size - 1.0);
    return glm::length(c + cell.size) <= 1;
  }

  void add(const Place& place, double weight, const Direction& value) {
    tiles_.at(place.face, place.column(), place.row()).add({weight * value, weight, Colour(value)});
  }

  void quarter(const Cell& cell) {
    const Vec2<double> half = 0.5 * cell.size, from = cell.from;
    const std::array<Vec2<double>, 5> points{{{from.x + half.x, from.y},
                                              {from.x, from.y + half.y},
                                              from + half,
                                              {from.x + cell.size.x, from.y + half.y},
                                              {from.x + half.x, from.y + cell.size.y}}};
    std::array<Place, 5> p;
    place(face_, points, p);
    const auto& c = cell.corners;
    const int depth = cell.depth + 1;
    part({from, half, {c[0], p[0], p[1], p[2]}, depth});
    part({points[0], half, {p[0], c[1], p[2], p[3]}, depth});
    part({points[1], half, {p[1], p[2], c[2], p[4]}, depth});
    part({points[2], half, {p[2], p[3], p[4], c[3]}, depth});
  }

  // A texel, or a quarter of one or less, which then lies in one patch of the reconstruction.
  void part(const Cell& cell) {
    const Vec2<double> middle[1] = {cell.from + 0.5 * cell.size};
    double density[1];
    densities(source_.projection(), middle, density);
    const double weight = density[0] * cell.size.x * cell.size.y;
    const bool whole = inside_disc(cell), smallest = cell.depth == deepest || (!whole && cell.depth > 5);
    if (!whole && !smallest) return quarter(cell);
    if (weight == 0) return;
    const double at_stake = stake(cell, weight);
    const auto& c = cell.corners;
    const double slope =
        std::max(std::abs(c[0].density - c[3].density), std::abs(c[1].density - c[2].density)) / density[0];
    // What the rule misses of the product of two slopes is a twelfth of it, and round a pole all of one sign.
    if (!smallest && at_stake * slope > 1) return quarter(cell);
    // A whole texel has kinks through its middle, over which a twentieth of its range goes wrong at worst, a few of
    // many.
    if (cell.depth == 0 && (at_stake > 60 || cell.in_one_texel())) return quarter(cell);
    const auto value = [&] { return Direction(bilinear(source_, {face_, middle[0].x, middle[0].y})); };
    if (cell.in_one_texel()) return add(cell.inside(), weight, value());
    Place centre[1];
    place(face_, middle, centre);
    const double bent = cell.on_one_face() ? bend(cell, centre[0]) : 1e300;
    if ((at_stake > 0 ? at_stake * bent : bent) <= 1 || (smallest && bent < 0.1))
      return cut(cell, weight, at_stake > 4);
    if (!smallest && at_stake > 0.5) return quarter(cell);
    add(centre[0], weight, value());
  }

  // The range of a cell's light over what the tolerance lets be wrong in a texel of the result: what falls into the wrong
  // one of two neighbours of the same radiance does no harm. What else the texel holds is guessed by the darkest near.
  [[nodiscard]] double stake(const Cell& cell, double weight) const {
    const double x = cell.from.x * source_.width(), y = cell.from.y * source_.height();
    const Colour* c = source_.texel(face_, static_cast<int>(x) - 1, static_cast<int>(y) - 1);
    float low = std::numeric_limits<float>::max(), high = 0;
    for (int j = 0; j < 3; ++j, c += source_.stride())
      for (int i = 0; i < 3; ++i) {
        low = std::min(low, std::min({c[i].x, c[i].y, c[i].z}));
        high = std::max(high, std::max({c[i].x, c[i].y, c[i].z}));
      }
    double texel = 4 * pi;  // The smallest that the cell may fall into.
    for (const Place& p : cell.corners) texel = std::min(texel, task_.steradians_at(p.column(), p.row()));
    // A texel has about 8 x its width in source texels of border, whose errors add up as independent ones. All of a sliver
    // at a rim is border, with errors of one sign.
    const double share = std::sqrt(weight * (1 << 2 * cell.depth) / texel) / 8;
    const double sliver = on_disc(target_.to) ? std::min(1.0, texel / task_.mean_steradians) : 1;
    const double allowed = task_.tolerance * std::sqrt(std::min(1.0, share)) * sliver *
                           std::max(texel * std::max<double>(low, task_.floor), weight * high);
    return allowed > 0 ? weight * (high - low) / allowed : 0;
  }

  // How far the map from the cell to the result is from a parallelogram, over the cell's size.
  static double bend(const Cell& cell, const Place& centre) {
    const auto& c = cell.corners;
    const double size = std::max(
        {std::abs(c[3].x - c[0].x), std::abs(c[2].x - c[1].x), std::abs(c[3].y - c[0].y), std::abs(c[2].y - c[1].y)});
    if (size > 2) return 1e300;  // Over several texels, or round a pole.
    const double twist = std::hypot(c[0].x - c[1].x - c[2].x + c[3].x, c[0].y - c[1].y - c[2].y + c[3].y);
    const double bulge = std::hypot(centre.x - 0.25 * (c[0].x + c[1].x + c[2].x + c[3].x),
                                    centre.y - 0.25 * (c[0].y + c[1].y + c[2].y + c[3].y));
    return (twist + bulge) / std::max(size, 1e-300);
  }

  // Parts of the cell between the borders of the result's texels, by the parallelogram through its corners.
  void cut(const Cell& cell, double weight, bool exact) {
    const auto& c = cell.corners;
    const Vec2<double> p[4] = {{c[0].x, c[0].y}, {c[1].x, c[1].y}, {c[2].x, c[2].y}, {c[3].x, c[3].y}};
    const Vec2<double> du = 0.5 * (p[1] - p[0] + p[3] - p[2]), dv = 0.5 * (p[2] - p[0] + p[3] - p[1]);
    const Vec2<double> from = 0.25 * (p[0] + p[1] + p[2] + p[3]) - 0.5 * (du + dv);
    const auto [x0, x1, y0, y1] = cell.reach();
    Polygon square;
    for (const Vec2<double>& corner : {Vec2<double>(0, 0), {1, 0}, {1, 1}, {0, 1}}) square.add(corner);
    for (int x = x0; x <= x1; ++x) {
      Polygon column = square;
      if (x > x0) column = column.cut(du.x, dv.x, from.x - x);
      if (x < x1) column = column.cut(-du.x, -dv.x, x + 1 - from.x);
      for (int y = y0; y <= y1; ++y) {
        Polygon part = column;
        if (y > y0) part = part.cut(du.y, dv.y, from.y - y);
        if (y < y1) part = part.cut(-du.y, -dv.y, y + 1 - from.y);
        add_polygon(cell, part, {c[0].face, x + 0.5, y + 0.5, 0}, weight, exact);
      }
    }
  }

  // The value at the centroid, which is exact for what is linear; where much is at stake the middles of the sides of
  // triangles, which integrate a bilinear patch exactly.
  void add_polygon(const Cell& cell, const Polygon& polygon, const Place& to, double weight, bool exact) {
    const auto value = [&](const Vec2<double>& p) {
      const Vec2<double> at = cell.from + p * cell.size;
      return Direction(bilinear(source_, {face_, at.x, at.y}));
    };
    double area = 0;
    Vec2<double> moment{0};
    for (std::size_t k = 2; k < polygon.count; ++k) {
      const Vec2<double>&a = polygon.points[0], &b = polygon.points[k - 1], &c = polygon.points[k];
      const double part = 0.5 * std::abs((b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x));
      area += part;
      moment += part / 3.0 * (a + b + c);
      if (exact && part > 0)
        add(to, part * weight, (value(0.5 * (a + b)) + value(0.5 * (b + c)) + value(0.5 * (c + a))) / 3.0);
    }
    if (!exact && area > 0) add(to, area * weight, value(moment / area));
  }

  const Task& task_;
  const Level& source_;
  const Target& target_;
  Rotation to_result_;
  double width_, height_;  // Of the result.
  Tiles tiles_;
  int face_ = -1, row_below_ = -1;
  std::vector<Place> above_, below_;
  std::vector<Vec2<double>> points_;
  std::vector<Direction> directions_;
  std::vector<Location<double>> locations_;
  std::vector<double> densities_, place_densities_;
  std::vector<Colour> column_, smooth_;
};

// All that falls into each texel of the result: bands in parallel, added up in their order.
std::vector<Caught> catch_all(const Task& task) {
  const Level& source = task.source;
  const Target& target = task.target;
  const int width = task.width, rows = source.faces() * source.height(), bands = (rows + band_rows - 1) / band_rows;
  std::vector<Caught> sums(static_cast<std::size_t>(faces(target.to)) * static_cast<std::size_t>(width) *
                           static_cast<std::size_t>(target.size));
  for (int first = 0; first < bands; first += bands_at_once) {
    const int count = std::min(bands_at_once, bands - first);
    std::vector<std::unique_ptr<Band>> done(static_cast<std::size_t>(count));
    tbb::parallel_for(0, count, [&](int k) {
      auto band = std::make_unique<Band>(task);
      const int begin = (first + k) * band_rows;
      for (int r = begin; r < std::min(begin + band_rows, rows); ++r)
        band->add_row(r / source.height(), r % source.height());
      done[static_cast<std::size_t>(k)] = std::move(band);
    });
    for (const auto& band : done) band->tiles().add_to(sums, width, target.size);
  }
  return sums;
}

}  // namespace

bool suits_conservative(const Level& source, const Target& target) {
  return source.projection() != Projection::sphere &&
         matching_size(source.projection(), source.height(), Projection::latlong) >= 64 &&
         5 * target.size <= 4 * matching_size(source.projection(), source.height(), target.to);
}

Level conservative_area(const Level& source, const Target& target, double tolerance, double floor) {
  const Task task{source, target, tolerance, floor};
  const std::vector<Caught> sums = catch_all(task);
  const Sampler fallback = area_sampler(source, target, tolerance, floor);
  const auto width = static_cast<std::size_t>(task.width);
  Level result(target.to, target.size);
  tbb::parallel_for(0, result.faces() * result.height(), [&](int r) {
    const int face = r / result.height(), row = r % result.height();
    const Columns in = columns(target.to, target.size, row);
    for (int i = in.first; i < in.end; ++i) {
      const Caught& sum = sums[static_cast<std::size_t>(r) * width + static_cast<std::size_t>(i)];
      // A sliver at a rim, thinner than any cell, is left to the other way.
      const double steradians = task.steradians_at(i, row);
      if (sum.weight > 0 && (!on_disc(target.to) || steradians > 0.01 * task.mean_steradians))
        *result.texel(face, i, row) = sum.mean(steradians);
      else
        fallback(face, row, i, {result.texel(face, i, row), 1});
    }
  });
  return result;
}

}  // namespace envmap
