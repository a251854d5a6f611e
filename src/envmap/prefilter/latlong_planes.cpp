// The light of a latlong map on its finest grid.

#include <algorithm>
#include <numeric>

#include "envmap/base/parallel.h"
#include "envmap/maths/portable.h"
#include "envmap/prefilter/light_planes.h"

namespace envmap::prefiltering {

namespace {

// One row of texels as its share in the columns of a grid. Columns a period apart have the same weights, some
// texels on.
class Across {
 public:
  Across(int width, int columns) : period_(columns / std::gcd(width, columns)), step_(width / (columns / period_)) {
    const Terms terms = adjoint(width, columns, true, [](double) { return 2 * pi; });
    int first = width, last = -width;
    const auto place = [&](int k, const Term& t) {  // Beside the column, not a turn away.
      const int middle = int((k + 0.5) * width / columns), off = (t.from - middle + width + width / 2) % width;
      return middle + off - width / 2;
    };
    for (int k = 0; k < period_; ++k)
      for (const Term& t : terms[std::size_t(k)])
        first = std::min(first, place(k, t)), last = std::max(last, place(k, t));
    first_ = first;
    for (int k = 0; k < period_; ++k) {
      int from = last, to = first;
      for (const Term& t : terms[std::size_t(k)]) from = std::min(from, place(k, t)), to = std::max(to, place(k, t));
      Phase& phase = phases_.emplace_back();
      phase.first = from - first;
      phase.weights.resize(std::size_t(to - from + 8) / 8 * 8);
      for (const Term& t : terms[std::size_t(k)]) phase.weights[std::size_t(place(k, t) - from)] = t.weight;
      reach_ = std::max(reach_, phase.first + int(phase.weights.size()));
    }
  }

  void apply(std::span<const float> texels, std::span<float> out) const {
    thread_local std::vector<float> padded, some;
    const int width = int(texels.size()), size = width + reach_;
    padded.resize(std::size_t(size));
    for (int k = 0, at = (first_ % width + width) % width, run = 0; k < size; k += run, at = 0) {
      run = std::min(size - k, width - at);
      std::copy_n(&texels[std::size_t(at)], run, &padded[std::size_t(k)]);
    }
    some.resize(out.size() / std::size_t(period_));
    for (std::size_t n = 0; n < phases_.size(); ++n) {
      const std::span to = period_ == 1 ? out : std::span(some);
      dot_products(std::span(padded).subspan(std::size_t(phases_[n].first)), std::size_t(step_), phases_[n].weights,
                   to);
      if (period_ > 1)
        for (std::size_t k = 0; k < to.size(); ++k) out[k * std::size_t(period_) + n] = to[k];
    }
  }

 private:
  struct Phase {
    int first = 0;
    std::vector<float> weights;
  };
  int period_, step_, first_ = 0, reach_ = 0;
  std::vector<Phase> phases_;
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
