// The light of a latlong map on its finest grid.

#include <algorithm>

#include "envmap/base/parallel.h"
#include "envmap/maths/portable.h"
#include "envmap/prefilter/light_planes.h"

namespace envmap::prefiltering {

namespace {

// One row of texels as its share in the columns of a grid.
class Across {
 public:
  Across(int width, int columns)
      : step_(width % columns == 0 ? width / columns : 0),
        terms_(adjoint(width, columns, true, [](double) { return 2 * pi; })) {
    if (step_ == 0) return;
    // All columns have the weights of column 0, a step on. Weights of texels left of it lie at the end.
    const auto place = [&](const Term& t) { return t.from < width / 2 ? t.from : t.from - width; };
    const auto by_place = [&](const Term& a, const Term& b) { return place(a) < place(b); };
    first_ = place(*std::ranges::min_element(terms_[0], by_place));
    const int count = place(*std::ranges::max_element(terms_[0], by_place)) - first_ + 1;
    weights_.resize(std::size_t(count + 7) / 8 * 8);
    for (const Term& t : terms_[0]) weights_[std::size_t(place(t) - first_)] = t.weight;
    terms_.clear();
  }

  void apply(std::span<const float> texels, std::span<float> out) const {
    if (step_ > 0) {
      thread_local std::vector<float> padded;
      const int width = int(texels.size()), size = width + int(weights_.size());
      padded.resize(std::size_t(size));
      for (int k = 0, at = (first_ % width + width) % width, run = 0; k < size; k += run, at = 0) {
        run = std::min(size - k, width - at);
        std::copy_n(&texels[std::size_t(at)], run, &padded[std::size_t(k)]);
      }
      return dot_products(padded, std::size_t(step_), weights_, out);
    }
    for (std::size_t i = 0; i < out.size(); ++i) {
      out[i] = 0;
      for (const Term& t : terms_[i]) out[i] += t.weight * texels[std::size_t(t.from)];
    }
  }

 private:
  int step_, first_ = 0;
  Terms terms_;
  std::vector<float> weights_;
};

}  // namespace

// Bands of rows read the rows of the source that they need, each once, in one order whatever the number of threads.
LightPlanes latlong_planes(const Level& source, double unit, const Colour& darkest, int rows) {
  LightPlanes out(rows, 2 * rows);
  const Terms down = adjoint(source.height(), rows, false, [](double v) { return pi * portable::sin_pi(v); });
  const Across across(source.width(), 2 * rows);
  const double scale = 1 / unit;  // Beyond floats where light is subnormal.
  const int band = std::max(16, rows / 16);
  parallel_for((rows + band - 1) / band, [&](int b) {
    const int low = b * band, high = std::min(rows, low + band);
    std::vector<std::pair<Term, int>> terms;  // And the row they add to.
    for (int r = low; r < high; ++r)
      for (const Term& t : down[std::size_t(r)]) terms.emplace_back(t, r);
    std::ranges::stable_sort(terms, {}, [](const auto& t) { return t.first.from; });
    std::vector<float> texels(std::size_t(source.width()));
    std::array<std::vector<float>, 3> narrow;
    int read = -1;
    for (const auto& [term, to] : terms) {
      if (term.from != read) {
        read = term.from;
        const auto row = source.row(0, read);
        for (int c = 0; c < 3; ++c) {
          for (std::size_t i = 0; i < texels.size(); ++i) texels[i] = float(double(row[i][c] - darkest[c]) * scale);
          narrow[std::size_t(c)].resize(std::size_t(out.columns));
          across.apply(texels, narrow[std::size_t(c)]);
        }
        source.trim();
      }
      for (int c = 0; c < 3; ++c) add_row(narrow[std::size_t(c)], term, out.row(to, c));
    }
  });
  return out;
}

}  // namespace envmap::prefiltering
