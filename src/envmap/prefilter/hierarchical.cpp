#include "envmap/prefilter/hierarchical.h"

#include <cmath>
#include <cstdint>
#include <optional>

#include "envmap/operate/measure.h"
#include "envmap/base/parallel.h"
#include "envmap/prefilter/cell.h"
#include "envmap/prefilter/exact.h"
#include "envmap/projection/visit.h"

namespace envmap {
namespace {

constexpr double floor_of_error = 1e-3;       // Of the mean: smaller results are held to this.
constexpr std::size_t tile_lights = 1 << 14;  // Of a tile: where there are more, fewer directions share them.

// ---- below the stored blocks ------------------------------------------------------------------------------------------

// The texels of blocks that were not good enough, and their parts, judged four at a time.
template <class P, class Add>
class Cutter {
 public:
  /// @param add what takes the lights.
  Cutter(const LightTree& tree, const Lobe& lobe, View& view, Walked& found, Add add)
      : tree_(tree), lobe_(lobe), view_(view), found_(found), add_(std::move(add)) {}

  void open(const Opened& block) {
    const Level& source = tree_.source();
    const int side = 1 << tree_.first(), left = block.i * side, top = block.j * side;
    open(block.face, {left, top, std::min(source.width(), left + side), std::min(source.height(), top + side)});
  }

 private:
  static constexpr int deepest = 24;

  // Four smaller blocks, or the texels.
  void open(int face, const Span& in) {
    const std::optional<std::array<Light, 4>> lights = tree_.quarters(face, in);
    if (!lights) return texels(face, in);
    judge_all(*lights, [&](std::size_t k) {
      open(face, in.quarters()[k]);
      return true;
    });
  }
  void texels(int face, const Span& in) {
    const Level& source = tree_.source();
    const double w = source.width(), h = source.height(), scale = tree_.mean() > 0 ? 1 / tree_.mean() : 0;
    Four<Rect> four;
    for (int j = in.top; j < in.bottom; ++j)
      for (int i = in.left; i < in.right; ++i)
        take(face, Rect{i / w, j / h, (i + 1) / w, (j + 1) / h}, scale * Flux(*source.texel(face, i, j)), 0, four);
    judge_all(face, 0, four);
  }

  template <class Cell>
  struct Four {
    std::size_t count = 0;
    std::array<Cell, 4> cells;
    std::array<Flux, 4> radiance;
    std::array<Light, 4> lights;
  };

  // Four points do not see how much of a cell the rim cuts off, and where: its parts do, while it is large.
  std::optional<Patch> moments(int face, const Rect& cell, int depth) const {
    if (depth < 6 && is_cut<P>(cell) && !at_rim<P>(cell)) return patch<P>(face, cell);
    return small_cell<P>(face, cell, depth >= deepest);
  }
  std::optional<Patch> moments(int face, const Wedge& cell, int depth) const {
    return small_cell<P>(face, cell, depth >= deepest);
  }
  // What is too large for simple moments is cut without a look at it.
  template <class Cell>
  void take(int face, const Cell& cell, const Flux& radiance, int depth, Four<Cell>& four) {
    const std::optional<Patch> area = moments(face, cell, depth);
    if (!area) return depth == 0 ? cut_texel(face, cell, radiance) : cut(face, cell, radiance, depth);
    if (area->solid_angle <= 0) return;
    four.cells[four.count] = cell;
    four.radiance[four.count] = radiance;
    four.lights[four.count++] = light_of(*area, radiance);
    if (four.count == 4) judge_all(face, depth, four);
  }
  // The parts of one texel are lit alike and lie in one place: their errors are not as independent as those of others.
  template <class Cell>
  void cut_texel(int face, const Cell& cell, const Flux& radiance) {
    constexpr double alike = 0.3;
    const double power = found_.power, sum = found_.sum;
    cut(face, cell, radiance, 0);
    const double together = alike * (found_.sum - sum);
    found_.power = std::max(found_.power, power + together * together);
  }
  template <class Cell>
  void cut(int face, const Cell& cell, const Flux& radiance, int depth) {
    if (found_.count > view_.most_lights) return;
    Four<Rect> rects;
    Four<Wedge> wedges;
    for_parts<P>(cell, [&](const auto& part) {
      if constexpr (std::is_same_v<std::decay_t<decltype(part)>, Rect>)
        take(face, part, radiance, depth + 1, rects);
      else
        take(face, part, radiance, depth + 1, wedges);
    });
    judge_all(face, depth + 1, rects);
    judge_all(face, depth + 1, wedges);
  }
  template <class Cell>
  void judge_all(int face, int depth, Four<Cell>& four) {
    if (four.count > 0)
      judge_all(std::span(four.lights).first(four.count), [&](std::size_t k) {
        if (depth == 0) {
          cut_texel(face, four.cells[k], four.radiance[k]);
        } else if (depth < deepest) {
          cut(face, four.cells[k], four.radiance[k], depth);
        }
        return depth < deepest;
      });
    four.count = 0;
  }
  // Of lights that are not good enough worse(k) says whether it did something about them.
  template <class Worse>
  void judge_all(std::span<const Light> lights, Worse&& worse) {
    Bunch bunch = Bunch::none();
    for (std::size_t k = 0; k < lights.size(); ++k) bunch.set(k, lights[k], view_.middle);
    const Verdict v = judge(lobe_, view_, bunch, lights.size());
    for (std::size_t k = 0; k < lights.size(); ++k) {
      if (!(v.visible >> k & 1) || (!(v.good >> k & 1) && worse(k))) continue;
      if (view_.surveying) {
        found_.add_least(view_, lights[k].flux, v.least[k]);
      } else {
        found_.add_error(v.error[k]);
        add_(lights[k]);
      }
    }
  }

  const LightTree& tree_;
  const Lobe& lobe_;
  View& view_;
  Walked& found_;
  Add add_;
};

// Calls add(light) for lights that are good enough for the directions of a view. @return their remainders, as if they were
// independent; nothing where there are more than `most_lights`.
template <class Add>
std::optional<double> good_lights(const LightTree& tree, const Lobe& lobe, const Direction& middle, double radius,
                                  const Accuracy& accuracy, std::size_t most_lights, Add add) {
  constexpr auto least = static_cast<float>(1 / floor_of_error);
  thread_local Walked found;
  View view{.middle = middle, .radius = radius, .most = {least, least, least, 1}, .surveying = true};
  visit(tree.source().projection(), [&](auto p) {
    Cutter<decltype(p), Add> cutter(tree, lobe, view, found, add);
    const auto go = [&] {
      walk(tree, lobe, view, found);
      for (const Opened& block : found.opened) cutter.open(block);
    };
    // The least that any direction gets, from below: first from afar, then closer.
    for (const float gap : {1.F, 0.05F}) {
      view.limit = gap;
      go();
    }
    view.surveying = false;
    // White counts for as much as radiance() takes of it.
    view.most[3] = 0;
    for (std::size_t c = 0; c < 3; ++c)
      view.most[3] = std::max(view.most[3], view.most[c] * tree.darkest()[static_cast<int>(c)]);
    view.limit = static_cast<float>(accuracy.light);
    view.most_lights = most_lights;
    go();
  });
  if (found.count > most_lights) return std::nullopt;
  for (const Light* light : found.lights) add(*light);
  return std::sqrt(found.power);
}

// ---- tiles ------------------------------------------------------------------------------------------------------------

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

constexpr double exactly = -1;  // The doubt of texels that are left to the exact sum.

// What the tiles of a map share.
struct Job {
  const LightTree& tree;
  const Lobe& lobe;
  const Target& target;
  const Accuracy& accuracy;
  double radius;
  Level& out;
  std::vector<float>& doubt;
};

// Lights of one direction, beyond which the exact sum is quicker.
std::size_t most_of_one(const LightTree& tree) {
  const auto& s = tree.source();
  return std::max<std::size_t>(1 << 14, static_cast<std::size_t>(s.faces()) * static_cast<std::size_t>(s.width()) *
                                            static_cast<std::size_t>(s.height()) / 8);
}

// What lights come to. The darkest radiance falls from everywhere, and its integral is known: what white misses of 1 it is
// given back. So all of a white map comes out right.
Flux radiance(const LightTree& tree, const Flux& sums, double white) {
  return tree.mean() * glm::max(Flux(0), sums + (1 - white) * Flux(tree.darkest()));
}

// Sets the colours of a tile. @return the remainders, or nothing where that would take more lights.
std::optional<double> gather_tile(const LightTree& tree, const Lobe& lobe, const Accuracy& accuracy,
                                  std::size_t most_lights, Tile& tile, std::span<Colour> out) {
  thread_local std::vector<Lamp> lamps;
  lamps.clear();
  const std::optional<double> left =
      good_lights(tree, lobe, tile.middle, radius_of(tile), accuracy, most_lights,
                  [&](const Light& light) { lamps.push_back(lamp_of(light, tile.middle)); });
  if (!left) return left;
  gather(lobe, lamps, tile);
  for (std::size_t k = 0; k < tile.count; ++k) {
    out[k] = Colour(radiance(tree, {tile.sums[0][k], tile.sums[1][k], tile.sums[2][k]}, tile.sums[3][k]));
  }
  return left;
}

// One direction. @return the remainders, or nothing where the exact sum is quicker.
std::optional<double> gather_direction(const LightTree& tree, const Lobe& lobe, const Accuracy& accuracy,
                                       const Direction& direction, Flux& out) {
  thread_local std::vector<Sight> sights;
  sights.clear();
  std::size_t count = 0;
  const std::optional<double> left = good_lights(tree, lobe, direction, 0, accuracy, most_of_one(tree),
                                                 [&](const Light& light) { add_sight(light, direction, count, sights); });
  if (!left) return left;
  const std::array<double, light_channels> sums = gather(lobe, sights);
  out = radiance(tree, {sums[0], sums[1], sums[2]}, sums[3]);
  return left;
}

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
  std::array<Colour, Tile::most> colours;
  std::optional<double> doubt;
  if (count == 1 || radius_of(tile) <= job.radius)
    doubt = gather_tile(job.tree, job.lobe, job.accuracy, count > 1 ? tile_lights : most_of_one(job.tree), tile, colours);
  if (!doubt && count == 1) doubt = exactly;
  if (!doubt) {
    const int left = w >= h ? w / 2 : w, top = w >= h ? h : h / 2;
    fill_tile(job, face, x, y, left, top);
    if (w >= h)
      fill_tile(job, face, x + left, y, w - left, h);
    else
      fill_tile(job, face, x, y + top, w, h - top);
    return;
  }
  for (std::size_t k = 0; k < count; ++k) {
    const Texel& t = texels[k];
    *job.out.texel(t.face, t.i, t.j) = colours[k];
    job.doubt[index_of(job.out, t)] = static_cast<float>(*doubt);
  }
}

// The texels that are left to the exact sum, all together.
void set_exactly(const Job& job) {
  std::vector<Texel> left;
  for (const Texel& t : texels_of(job.out)) {
    float& doubt = job.doubt[index_of(job.out, t)];
    if (doubt != static_cast<float>(exactly)) continue;
    doubt = 0;
    left.push_back(t);
  }
  exact_texels(job.tree.source(), job.lobe, job.target, left, job.out);
}

}  // namespace

double tile_radius(const Lobe& lobe) {
  return std::visit(
      [](const auto& l) {
        const double radius = 0.7 * std::sqrt(2 * l.width());
        return l.value(0.9) > 1e-3 ? std::min(radius, 0.1) : radius;
      },
      lobe);
}

std::optional<double> gather_directions(const LightTree& tree, const Lobe& lobe, const Accuracy& accuracy,
                                        std::span<const Direction> directions, std::span<Flux> out) {
  constexpr std::size_t few = 6;  // Less are quicker one by one.
  if (directions.size() == 1) return gather_direction(tree, lobe, accuracy, directions[0], out[0]);
  if (directions.size() >= few && directions.size() <= Tile::most) {
    Tile tile;
    set_tile(directions, tile);
    std::array<Colour, Tile::most> colours;
    std::optional<double> left;
    if (radius_of(tile) <= tile_radius(lobe)) left = gather_tile(tree, lobe, accuracy, tile_lights, tile, colours);
    if (left) {
      std::copy_n(colours.begin(), directions.size(), out.begin());
      return left;
    }
  }
  const std::size_t half = directions.size() / 2;
  const auto first = gather_directions(tree, lobe, accuracy, directions.first(half), out.first(half));
  if (!first) return first;
  const auto second = gather_directions(tree, lobe, accuracy, directions.subspan(half), out.subspan(half));
  return second ? std::max(*first, *second) : second;
}

std::vector<float> hierarchical_prefilter(const LightTree& tree, const Lobe& lobe, const Target& target,
                                          const Accuracy& accuracy, Level& out, const Progress& progress) {
  constexpr int side = 8;
  std::vector<float> doubt(index_of(out, {out.faces(), 0, 0}), 0);
  const Job job{tree, lobe, target, accuracy, tile_radius(lobe), out, doubt};
  for_each_row(out.faces(), (out.height() + side - 1) / side, progress, [&](int face, int row) {
    const int y = row * side, h = std::min(side, out.height() - y);
    for (int x = 0; x < out.width(); x += side) fill_tile(job, face, x, y, std::min(side, out.width() - x), h);
  });
  set_exactly(job);
  return doubt;
}

}  // namespace envmap
