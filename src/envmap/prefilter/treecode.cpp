#include "envmap/prefilter/treecode.h"

#include <cmath>
#include <cstdint>

#include "envmap/base/parallel.h"
#include "envmap/operate/measure.h"
#include "envmap/prefilter/error_floor.h"
#include "envmap/prefilter/subdivide.h"
#include "envmap/prefilter/work.h"

namespace envmap::prefiltering {
namespace {

constexpr int tile_side = 8;

// What the tiles of a map share.
struct Job {
  const Tree& tree;
  const Lobe& lobe;
  double max_error;
  double radius;
  const Making& map;

  [[nodiscard]] float& figure(const Texel& t) const { return map.bounds[index_of(map.out, t)]; }
};

// How far from their middle directions may be that share nodes: these are as many as the worst of the directions needs.
// What was fastest. None share where the horizon clips texels.
double tile_radius(const Lobe& lobe) {
  return std::visit(
      [](const auto& l) {
        if (l.breaks_off()) return 0.0;
        const double radius = 0.5 * std::sqrt(2 * l.width());
        return l.value(0.9) > 1e-3 ? std::min(radius, 0.08) : radius;
      },
      lobe);
}

// Directions -> tile.
void set_tile(std::span<const Direction> directions, Tile& tile) {
  Direction sum(0);
  for (const Direction& d : directions) sum += d;
  tile.middle = directions.size() > 1 && glm::length(sum) > 0.1 ? glm::normalize(sum) : directions[0];
  tile.count = directions.size();
  double square = 0;
  for (std::size_t k = 0; k < Tile::most; ++k) {
    const Vec3<float> o(directions[std::min(k, tile.count - 1)] - tile.middle);
    tile.x[k] = o.x, tile.y[k] = o.y, tile.z[k] = o.z;
    square = std::max(square, double(o.x * o.x + o.y * o.y + o.z * o.z));
  }
  tile.radius = std::sqrt(square);
}

// Nodes beyond which the exact sum of so many directions is quicker, or fewer directions at a time are. The exact sum
// goes round every texel that the horizon of a lobe that breaks off cuts, and cuts those of a coarse map: a face of one
// texel takes it as long as thousands of nodes.
std::size_t max_nodes(const Tree& tree, const Lobe& lobe, std::size_t directions) {
  const Level& s = tree.source();
  const std::size_t texels = index_of(s, {s.faces(), 0, 0}), parts = std::size_t(tree.parts());
  const std::size_t sum = directions * (parts > 1 ? 8 * texels / (parts * parts) : texels / 8);
  const bool breaks_off = std::visit([](const auto& l) { return l.breaks_off(); }, lobe);
  const std::size_t least = breaks_off ? 1 << 14 : parts > 1 ? 1 << 12 : 1 << 8;
  return std::clamp<std::size_t>(sum, least, directions > 1 ? 1 << 14 : SIZE_MAX);
}

// The nodes of a tile, and what they are off.
class TileNodes {
 public:
  TileNodes(const Job& job, const Tile& tile) : job_(job), tile_(tile) {
    criterion_ = {.middle = tile.middle, .radius = tile.radius, .surveying = true};
    for (std::size_t c = 0; c < node_channels; ++c) {
      criterion_.darkest[c] = float(job.tree.darkest()[int(c)]);
      criterion_.most[c] = 1 / std::max(float(floor_of_mean), criterion_.darkest[c]);
    }
    // The least that any direction gets, from below: first from afar, then closer.
    for (const float gap : {1.F, 0.05F}) {
      criterion_.limit = gap;
      go([](const Node&) {});
    }
    criterion_.surveying = false;
    criterion_.max_nodes = max_nodes(job.tree, job.lobe, tile.count);
  }

  /// Of the last find(): see Traversal.
  static const std::array<double, node_channels>& integrated() { return found().integrated; }

  /// Opens nodes until their figure is below the error asked for. @param limit of the first try; set to that of the
  /// last.
  /// @param add takes the nodes. @return the figure, or nothing where there would be too many.
  template <class Clear, class Add>
  std::optional<double> find(double& limit, Clear&& clear, Add&& add) {
    constexpr int max_tries = 10;
    for (int n = 0; n < max_tries; ++n) {
      clear();
      criterion_.limit = float(limit);
      go(add);
      if (found().count > criterion_.max_nodes) return std::nullopt;
      const double figure = error_figure(found(), tile_);
      if (figure <= job_.max_error) {
        for (const Node* node : found().nodes) add(*node);
        for (const Node& node : found().channels) add(node);
        return figure;
      }
      limit *= std::clamp(0.7 * job_.max_error / figure, 0.05, 0.7);
    }
    return std::nullopt;
  }

 private:
  static Traversal& found() {
    thread_local Traversal kept;
    return kept;
  }
  template <class Add>
  void go(Add&& add) {
    traverse(job_.tree, job_.lobe, criterion_, found());
    visit_source(job_.tree.source().projection(), [&](auto p) {
      Subdivision<decltype(p), std::remove_reference_t<Add>> below(job_.tree, job_.lobe, criterion_, found(), add);
      for (const OpenBlock& block : found().opened) below.open(block);
    });
  }

  const Job& job_;
  const Tile& tile_;
  Criterion criterion_;
};

// What nodes come to.
Colour radiance(const Tree& tree, const Flux& sums) {
  return Colour(tree.mean() * glm::max(Flux(0), sums + tree.darkest()));
}

// Sets the colours of a tile. @return its figure, or nothing where it would take too many nodes.
std::optional<double> fill(const Job& job, double& limit, Tile& tile, std::span<Colour> out) {
  TileNodes nodes(job, tile);
  if (tile.count == 1) {
    thread_local std::vector<SeenNodes> seen;
    std::size_t count = 0;
    const std::optional<double> figure = nodes.find(
        limit, [&] { seen.clear(), count = 0; }, [&](const Node& node) { add_seen(node, tile.middle, count, seen); });
    if (!figure) return figure;
    envmap::prefiltering::count(Work::seen, count);
    std::array<double, node_channels> sums = evaluate(job.lobe, seen);
    for (std::size_t c = 0; c < node_channels; ++c) sums[c] += TileNodes::integrated()[c];
    out[0] = radiance(job.tree, {sums[0], sums[1], sums[2]});
    return figure;
  }
  thread_local std::vector<TileNode> seen;
  const std::optional<double> figure = nodes.find(
      limit, [&] { seen.clear(); },
      [&](const Node& node) { seen.push_back(seen_from_tile(node, tile.middle, tile.radius)); });
  if (!figure) return figure;
  count(Work::seen, seen.size() * tile.count);
  evaluate(job.lobe, seen, tile);
  for (std::size_t k = 0; k < tile.count; ++k)
    out[k] = radiance(job.tree, {tile.sums[0][k], tile.sums[1][k], tile.sums[2][k]});
  return figure;
}

// A block of texels of the result, cut until its directions are near each other and few nodes do for them. Texels for
// which there are none keep their figure. @param limit what nodes were allowed to be off in the tile before.
void fill_tile(const Job& job, int face, int x, int y, int w, int h, double& limit) {
  std::array<Direction, Tile::most> directions;
  std::array<Texel, Tile::most> texels;
  std::size_t count = 0, unknown = 0;
  for (int j = y; j < y + h; ++j) {
    const Columns in = columns(job.map.target.to, job.map.target.size, j);
    const int first = std::max(x, in.first), end = std::min(x + w, in.end);
    if (first >= end) continue;
    const std::span row = std::span(directions).subspan(count, std::size_t(end - first));
    texel_directions(job.map.target.to, job.map.target.size, face, j, first, row);
    for (int i = first; i < end; ++i) {
      texels[count++] = {face, i, j};
      unknown += job.figure(texels[count - 1]) <= float(job.max_error) ? 0 : 1;
    }
  }
  if (unknown == 0) return;
  const std::span all = std::span(directions).first(count);
  rotate(job.map.target.to_source, all);
  Tile tile;
  set_tile(all, tile);
  std::array<Colour, Tile::most> colours;
  std::optional<double> figure;
  if (count == 1 || tile.radius <= job.radius) figure = fill(job, limit, tile, colours);
  if (figure) {
    // The next tile is much the same: what made this one good will do there.
    limit *= std::clamp(0.8 * job.max_error / std::max(*figure, 1e-30), 0.5, 1.5);
    for (std::size_t k = 0; k < count; ++k) {
      *job.map.out.texel(texels[k].face, texels[k].i, texels[k].j) = colours[k];
      job.figure(texels[k]) = float(*figure);
    }
  } else if (count > 1) {
    const int left = w >= h ? w / 2 : w, top = w >= h ? h : h / 2;
    fill_tile(job, face, x, y, left, top, limit);
    if (w >= h)
      fill_tile(job, face, x + left, y, w - left, h, limit);
    else
      fill_tile(job, face, x, y + top, w, h - top, limit);
  }
}

}  // namespace

double error_figure(const Traversal& found, const Tile& tile) {
  std::array<float, Tile::most> crossed{};
  for (const CrossedNode& node : found.crossed)
    for (std::size_t k = 0; k < tile.count; ++k) {
      const float x = tile.x[k] - node.centre.x, y = tile.y[k] - node.centre.y, z = tile.z[k] - node.centre.z;
      crossed[k] += std::abs(0.5F * (x * x + y * y + z * z) - node.horizon) <= node.reach ? node.error : 0.F;
    }
  return found.figure(*std::ranges::max_element(crossed));
}

double treecode_cost(const Level& source, double texels, double max_error, double width) {
  const double size = double(index_of(source, {source.faces(), 0, 0}));
  const double root = portable::cbrt(1e3 * max_error), fine = 4.5 * pi / (width * root * root);
  return 22 * size + 2.2e6 * fine + texels * (700 + 28 * fine);
}

void treecode_prefilter(const Tree& tree, const Lobe& lobe, double max_error, const Making& map) {
  const Job job{tree, lobe, max_error, tile_radius(lobe), map};
  const int width = map.out.width(), height = map.out.height();
  for_each_row(map.out.faces(), (height + tile_side - 1) / tile_side, map.progress, [&](int face, int row) {
    const int y = row * tile_side, h = std::min(tile_side, height - y);
    bool any = false;
    for (int j = y; j < y + h; ++j) any = any || map.wants(face, j);
    if (!any) return;
    double limit = 0.3 * max_error;  // Of the first tile of a row, as good as any.
    for (int x = 0; x < width; x += tile_side)
      fill_tile(job, face, x, y, std::min(tile_side, width - x), h, limit), tree.source().trim();
  });
}

}  // namespace envmap::prefiltering
