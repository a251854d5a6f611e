#include "envmap/operate/levels.h"

#include <algorithm>
#include <vector>

#include "envmap/base/error.h"
#include "envmap/base/parallel.h"
#include "envmap/operate/refuse_flaws.h"
#include "envmap/projection/visit.h"
#include "envmap/sample/point.h"

namespace envmap {
namespace {

// Along one axis: the edges of the texels of both levels cut the face into cells. Those of texel k of the coarse level
// are [first[k], first[k + 1]): where a side is halved two, or three where its size is odd, or one where nothing is.
struct Cells {
  std::vector<double> edges;  // In units of the face, from 0 to 1.
  std::vector<int> source;    // The fine texel that each lies in.
  std::vector<int> first;
};

// Exact in doubles up to 2^26 texels a side.
Cells cells(int fine, int coarse) {
  Cells all{{0}, {}, {0}};
  for (int k = 0; k < coarse; ++k) {
    const double from = double(k) * fine / coarse, to = double(k + 1) * fine / coarse;
    for (int i = int(from); i < to; ++i) {
      all.edges.push_back(std::min<double>(to, i + 1) / fine);
      all.source.push_back(i);
    }
    all.first.push_back(int(all.source.size()));
  }
  return all;
}

// What the cells of one row of the coarse level count for, and the sum for each of its texels. Everything here is the
// same from the left and from the right, so half of it is computed.
struct RowWeights {
  std::vector<std::vector<double>> parts;  // By fine row, then by cell.
  std::vector<double> whole;               // By coarse texel.
};

void weigh(Projection p, Weights weights, const Cells& across, const Cells& down, int row, RowWeights& out) {
  const std::size_t count = across.source.size(), half = (count + 1) / 2;
  const auto first = std::size_t(down.first[row]), end = std::size_t(down.first[std::size_t(row) + 1]);
  out.whole.assign(across.first.size() - 1, 0);
  out.parts.resize(std::max(out.parts.size(), end - first));
  for (std::size_t part = 0; part < end - first; ++part) {
    std::vector<double>& w = out.parts[part];
    w.resize(count);
    const double v0 = down.edges[first + part], v1 = down.edges[first + part + 1];
    if (weights == Weights::uniform) {
      for (std::size_t c = 0; c < count; ++c) w[c] = (v1 - v0) * (across.edges[c + 1] - across.edges[c]);
    } else {
      solid_angles(p, std::span(across.edges).first(half + 1), v0, v1, std::span(w).first(half));
      std::copy_n(w.begin(), count - half, w.rbegin());
    }
    for (std::size_t i = 0; i < out.whole.size(); ++i)
      for (int c = across.first[i]; c < across.first[i + 1]; ++c) out.whole[i] += w[c];
  }
}

// One row of one face. @param rows of the fine level, one for each part. Where nothing counts, 0.
void mean_row(const Cells& across, const RowWeights& weights, std::span<const Colour* const> rows,
              std::span<Colour> out) {
  for (std::size_t i = 0; i < out.size(); ++i) {
    Rgb<double> sum(0);
    for (std::size_t part = 0; part < rows.size(); ++part)
      for (int c = across.first[i]; c < across.first[i + 1]; ++c)
        sum += weights.parts[part][c] * Rgb<double>(rows[part][across.source[c]]);
    out[i] = weights.whole[i] > 0 ? Colour(sum / weights.whole[i]) : Colour(0);
  }
}

// Texels of a paraboloid map without any part in the disc: what the other half shows in their direction.
void fill_beyond_disc(Level& level) {
  const PaddedLevel sound(level);
  sound.trim();
  const int n = level.height();
  // Of the near edge.
  const auto distance = [n](int i) { return std::max(0, std::abs(2 * i + 1 - n) - 1) / double(n); };
  parallel_for(n, [&](int j) {
    for (int i = 0; i < n; ++i) {
      if (distance(i) * distance(i) + distance(j) * distance(j) < 1) continue;
      for (int face = 0; face < level.faces(); ++face) {
        const Direction beyond = Paraboloid::direction(face, (i + 0.5) / n, (j + 0.5) / n);
        *level.texel(face, i, j) = bilinear(sound, Paraboloid::locate(beyond));
      }
    }
  });
}

void check_levels(const std::vector<Level>& levels, int count) {
  if (levels.empty()) throw UsageError("a map needs a level; this one has none");
  if (count != 0) check_range(limits::levels, count);
  require_finite(levels.back());  // Means of finite texels are finite.
}

}  // namespace

bool has_next(const Level& level) { return level.width() > 1 || level.height() > 1; }

Level half_level(const Level& fine, Weights weights) {
  return coarser_level(fine, std::max(1, fine.width() / 2), std::max(1, fine.height() / 2), weights);
}

Level coarser_level(const Level& fine, int width, int height, Weights weights) {
  check_enumerator("weights", weights);
  check_range({"width", 1, double(fine.width())}, width);
  check_range({"height", 1, double(fine.height())}, height);
  Level coarse(fine.projection(), height, width, fine.max_memory());
  const Cells across = cells(fine.width(), coarse.width()), down = cells(fine.height(), coarse.height());
  // Rows as far from the top as from the bottom share their weights, as do all faces.
  parallel_ranges((coarse.height() + 1) / 2, 1, [&](int begin, int end_row) {
    RowWeights shared;
    std::vector<const Colour*> rows;
    for (int row = begin; row < end_row; ++row) {
      weigh(fine.projection(), weights, across, down, row, shared);
      const auto first = std::size_t(down.first[row]), end = std::size_t(down.first[row + 1]);
      const std::span<const int> sources = std::span(down.source).subspan(first, end - first);
      const auto halve = [&](int face, bool mirrored) {
        rows.clear();
        for (const int source : sources)
          rows.push_back(fine.texel(face, 0, mirrored ? fine.height() - 1 - source : source));
        mean_row(across, shared, rows, coarse.row(face, mirrored ? coarse.height() - 1 - row : row));
      };
      for (int face = 0; face < fine.faces(); ++face) {
        halve(face, false);
        if (coarse.height() - 1 - row != row) halve(face, true);
      }
      fine.trim();
      coarse.trim();
    }
  });
  if (fine.projection() == Projection::paraboloid && weights == Weights::solid_angle) fill_beyond_disc(coarse);
  return coarse;
}

void add_levels_with_border(std::vector<Level>& levels, int border, Weights weights, int count) {
  check_levels(levels, count);
  check_range(limits::border, border);
  const int whole = levels.front().height() + 2 * border;
  for (int k = int(levels.size()); (whole >> k) > 2 * border && (count == 0 || k < count); ++k) {
    const int size = (whole >> k) - 2 * border;
    levels.push_back(coarser_level(levels.back(), size, size, weights));
  }
}

void add_levels(EnvironmentMap& map, Weights weights, int count) { add_levels(map.levels, weights, count); }

void add_levels(std::vector<Level>& levels, Weights weights, int count) {
  check_levels(levels, count);
  while (has_next(levels.back()) && (count == 0 || levels.size() < std::size_t(count)))
    levels.push_back(half_level(levels.back(), weights));
}

}  // namespace envmap
