#include "envmap/prefilter/hierarchical.h"

#include <cmath>

#include "envmap/operate/measure.h"
#include "envmap/operate/parallel.h"
#include "envmap/prefilter/cell.h"

namespace envmap {
namespace {

constexpr double floor_of_error = 1e-3;  // Of the mean: smaller results are held to this.

// What a light can do at most for the directions of a tile.
struct Reach {
  double near, far;  // Least and largest 1 - cos.
  double sine;       // Largest sine to its middle.
};

// Add: what takes the lights that are listed.
template <class P, class Add>
class Walk {
 public:
  Walk(const LightTree& tree, const LobeBounds& lobe, const Direction& middle, double radius, Add add)
      : tree_(tree), lobe_(lobe), middle_(middle), radius_(radius), add_(std::move(add)) {}

  // The least that any direction of the tile gets, from below: first from afar, then closer.
  void survey() {
    most_ = {1 / floor_of_error, 1 / floor_of_error, 1 / floor_of_error, 1};
    for (const double gap : {1.0, 0.05}) {
      got_ = {};
      limit_ = gap;
      top();
    }
    surveying_ = false;
  }

  // Hands over the lights.
  Gathered list(double limit) {
    limit_ = limit;
    bounds_ = {};
    top();
    return {bounds_.sum, std::sqrt(bounds_.power)};
  }

 private:
  void top() {
    for (int face = 0; face < P::faces; ++face) block(tree_.last(), face, 0, 0);
  }

  Reach reach(const Light& light) const {
    const double d = glm::length(light.centre - middle_);
    const double near = std::max(0.0, d - radius_ - light.reach), far = d + radius_ + light.reach;
    return {0.5 * near * near, std::min(2.0, 0.5 * far * far), std::min(1.0, d + radius_ + 0.5 * light.reach)};
  }

  // Remainder of the series, for a flux of 1.
  double remainder(const Light& light, const Reach& r) const {
    const LobeBounds::Step *const near = lobe_.at(r.near), *const far = lobe_.at(r.far), *last = far;
    double found = 0;
    const double extent = r.sine * light.reach;
    bool above = true;
    if (r.far >= 1) {
      // The horizon may cross the light: two lights for a bent lobe are wrong by a part of what it is there.
      found = 0.12 * lobe_.at(std::max(r.near, 1 - 2 * extent))->value;
      above = 1 - extent > r.near;
      if (above) last = lobe_.at(1 - extent);
    }
    if (above) {
      const double cube = r.sine * light.spread;
      found += 0.5 * std::max(near->second, last->second) * r.sine * r.sine * light.uneven +
               std::max(near->third, last->third) * cube * cube * cube / 3;
    }
    // Two means of the same lobe differ by what it changes at most: above the horizon its derivatives may have no bound.
    return std::min(found, 0.5 * (near->value - far[1].value));
  }

  bool good(const Light& light, const Reach& r) {
    double flux = 0;
    for (std::size_t c = 0; c < 4; ++c) flux = std::max(flux, light.flux[c] * most_[c]);
    if (surveying_) {
      const double gap = lobe_.at(r.near)->value - lobe_.at(r.far)[1].value;
      return light.reach < 0.5 * radius_ || gap * flux < limit_;
    }
    const double error = remainder(light, r) * flux;
    if (error > limit_) return false;
    bounds_.sum += error;
    bounds_.power += error * error;
    return true;
  }

  void take(const Light& light, const Reach& r) {
    if (!surveying_) return add_(light);
    const double value = lobe_.at(r.far)[1].value;
    for (std::size_t c = 0; c < 4; ++c) got_[c] += value * light.flux[c];
    for (std::size_t c = 0; c < 3; ++c) most_[c] = std::min(most_[c], 1 / got_[c]);
  }

  void block(int k, int face, int i, int j) {
    const Light& light = tree_.light(k, face, i, j);
    const Reach r = reach(light);
    if (r.near >= 1 || light.flux[3] <= 0) return;
    if (good(light, r)) return take(light, r);
    if (k == tree_.first()) return texels(face, i << k, j << k, 1 << k);
    const auto& finer = tree_.blocks(k - 1);
    for (int y = 2 * j; y < std::min(finer.height, 2 * j + 2); ++y)
      for (int x = 2 * i; x < std::min(finer.width, 2 * i + 2); ++x) block(k - 1, face, x, y);
  }

  void texels(int face, int left, int top, int side) {
    const Level& source = tree_.source();
    const double w = source.width(), h = source.height(), scale = tree_.mean() > 0 ? 1 / tree_.mean() : 0;
    for (int j = top; j < std::min(source.height(), top + side); ++j)
      for (int i = left; i < std::min(source.width(), left + side); ++i)
        piece(face, Rect{i / w, j / h, (i + 1) / w, (j + 1) / h}, scale * Flux(*source.texel(face, i, j)), 0);
  }

  // A texel or part of it. What is too large for simple moments is cut without a look at it.
  template <class Cell>
  void piece(int face, const Cell& cell, const Flux& radiance, int depth) {
    if (const std::optional<Patch> area = small_cell<P>(face, cell, depth >= 24)) {
      if (area->solid_angle <= 0) return;
      const Light light = light_of(*area, radiance);
      const Reach r = reach(light);
      if (r.near >= 1) return;
      if (depth >= 24 || good(light, r)) return take(light, r);
    }
    for_parts<P>(cell, [&](const auto& part) { piece(face, part, radiance, depth + 1); });
  }

  const LightTree& tree_;
  const LobeBounds& lobe_;
  Direction middle_;
  double radius_;
  std::array<double, 4> most_{}, got_{};  // 1 over the least of a channel; what was found of it so far.
  bool surveying_ = true;
  double limit_ = 0;
  struct {
    double sum = 0, power = 0;
  } bounds_;
  Add add_;
};

template <class Add>
Gathered list_lights(const LightTree& tree, const LobeBounds& bounds, const Direction& middle, double radius,
                     const Accuracy& accuracy, Add add) {
  return visit(tree.source().projection(), [&](auto p) {
    Walk<decltype(p), Add> walk(tree, bounds, middle, radius, add);
    walk.survey();
    return walk.list(accuracy.light);
  });
}

double radius_of(const Tile& tile) {
  double square = 0;
  for (std::size_t k = 0; k < tile.count; ++k)
    square = std::max(square, static_cast<double>(tile.x[k] * tile.x[k] + tile.y[k] * tile.y[k] + tile.z[k] * tile.z[k]));
  return std::sqrt(square);
}

// Directions -> tile.
void set_tile(std::span<const Direction> directions, Tile& tile) {
  Direction sum(0);
  for (const Direction& d : directions) sum += d;
  tile.middle = glm::length(sum) > 0.1 ? glm::normalize(sum) : directions[0];
  tile.count = directions.size();
  for (std::size_t k = 0; k < Tile::most; ++k) {
    const Vec3<float> o(directions[std::min(k, tile.count - 1)] - tile.middle);
    tile.x[k] = o.x, tile.y[k] = o.y, tile.z[k] = o.z;
  }
}

std::size_t index_of(const Level& level, const Texel& t) {
  const auto w = static_cast<std::size_t>(level.width()), h = static_cast<std::size_t>(level.height());
  return (static_cast<std::size_t>(t.face) * h + static_cast<std::size_t>(t.j)) * w + static_cast<std::size_t>(t.i);
}

// How far from their middle the directions of a tile may be: they share a list of lights, which is as long as the worst of
// them needs. The figures are those that were fastest.
double tile_radius(const Lobe& lobe) {
  return std::visit(
      [](const auto& l) {
        const double radius = 0.7 * std::sqrt(2 * l.width());
        return l.value(0.9) > 1e-3 ? std::min(radius, 0.1) : radius;
      },
      lobe);
}

// What the tiles of a map share.
struct Job {
  const LightTree& tree;
  const Lobe& lobe;
  const LobeBounds& bounds;
  const Target& target;
  const Accuracy& accuracy;
  double radius;
  Level& out;
  std::vector<float>& doubt;
};

// A block of texels of the result, cut until its directions are near each other.
void fill_tile(const Job& job, int face, int x, int y, int w, int h) {
  std::array<Direction, Tile::most> directions;
  std::array<Texel, Tile::most> texels;
  std::size_t count = 0;
  for (int j = y; j < y + h; ++j) {
    const Columns in = columns(job.target.to, job.target.size, j);
    const int first = std::max(x, in.first), end = std::min(x + w, in.end);
    if (first >= end) continue;
    const std::span row = std::span(directions).subspan(count, static_cast<std::size_t>(end - first));
    texel_directions(job.target.to, job.target.size, face, j, first, row);
    for (int i = first; i < end; ++i) texels[count++] = {face, i, j};
  }
  if (count == 0) return;
  const std::span all = std::span(directions).first(count);
  rotate(job.target.to_source, all);
  Tile tile;
  set_tile(all, tile);
  if (count > 1 && radius_of(tile) > job.radius) {
    const int left = w >= h ? w / 2 : w, top = w >= h ? h : h / 2;
    fill_tile(job, face, x, y, left, top);
    if (w >= h)
      fill_tile(job, face, x + left, y, w - left, h);
    else
      fill_tile(job, face, x, y + top, w, h - top);
    return;
  }
  std::array<Colour, Tile::most> colours;
  const Gathered gathered = gather_tile(job.tree, job.lobe, job.bounds, job.accuracy, tile, colours);
  for (std::size_t k = 0; k < count; ++k) {
    const Texel& t = texels[k];
    *job.out.texel(t.face, t.i, t.j) = colours[k];
    job.doubt[index_of(job.out, t)] = static_cast<float>(gathered.root);
  }
}

}  // namespace

Gathered gather_tile(const LightTree& tree, const Lobe& lobe, const LobeBounds& bounds, const Accuracy& accuracy,
                     Tile& tile, std::span<Colour> out) {
  thread_local std::vector<Lamp> lamps;
  lamps.clear();
  const Gathered gathered = list_lights(tree, bounds, tile.middle, radius_of(tile), accuracy,
                                        [&](const Light& light) { lamps.push_back(lamp_of(light, tile.middle)); });
  gather(lobe, lamps, tile);
  for (std::size_t k = 0; k < tile.count; ++k) {
    // White comes out as 1: what the lights miss of it they miss of all.
    const double scale = tree.mean() / tile.sums[3][k];
    out[k] = Colour(scale * tile.sums[0][k], scale * tile.sums[1][k], scale * tile.sums[2][k]);
  }
  return gathered;
}

Gathered gather_direction(const LightTree& tree, const Lobe& lobe, const LobeBounds& bounds, const Accuracy& accuracy,
                          const Direction& direction, Flux& out) {
  thread_local std::vector<Sight> sights;
  sights.clear();
  std::size_t count = 0;
  const Gathered gathered = list_lights(tree, bounds, direction, 0, accuracy,
                                        [&](const Light& light) { add_sight(light, direction, count, sights); });
  const std::array<double, light_channels> sums = gather(lobe, sights);
  out = tree.mean() / sums[3] * Flux(sums[0], sums[1], sums[2]);
  return gathered;
}

std::vector<float> hierarchical_prefilter(const LightTree& tree, const Lobe& lobe, const Target& target,
                                          const Accuracy& accuracy, Level& out, const Progress& progress) {
  constexpr int side = 8;
  const LobeBounds bounds(lobe);
  std::vector<float> doubt(index_of(out, {out.faces(), 0, 0}), 0);
  const Job job{tree, lobe, bounds, target, accuracy, tile_radius(lobe), out, doubt};
  for_each_row(out.faces(), (out.height() + side - 1) / side, progress, [&](int face, int row) {
    const int y = row * side, h = std::min(side, out.height() - y);
    for (int x = 0; x < out.width(); x += side) fill_tile(job, face, x, y, std::min(side, out.width() - x), h);
  });
  return doubt;
}

}  // namespace envmap
