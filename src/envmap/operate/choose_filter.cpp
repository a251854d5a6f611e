#include "envmap/operate/choose_filter.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>

#include "envmap/base/parallel.h"
#include "envmap/maths/compensated_sum.h"
#include "envmap/maths/portable.h"
#include "envmap/operate/measure.h"
#include "envmap/sample/sampler.h"

namespace envmap {
namespace {

constexpr std::size_t spread = 768, worst = 256, brightest = 256, beside_lights = 2048;  // Texels measured, at most.
constexpr std::int64_t searched = 1 << 20;  // Texels among which the worst are looked for, at most.

struct Candidate {
  Filter filter;
  int samples;
};

// The cheapest first, as tests/bench/convert_bench.cpp measures them (filter/NAME/x4); `area` comes after them.
constexpr Candidate candidates[] = {{Filter::nearest, 1},  {Filter::bilinear, 1}, {Filter::bicubic, 1},
                                    {Filter::bilinear, 2}, {Filter::bilinear, 4}, {Filter::bilinear, 8},
                                    {Filter::ewa, 1}};

// The filter's own result in single texels.
std::vector<Colour> sampled(const Sampler& sampler, std::span<const Texel> texels) {
  std::vector<Colour> out(texels.size());
  parallel_for(int(texels.size()), [&](int k) {
    const Texel& t = texels[std::size_t(k)];
    sampler(t.face, t.j, t.i, std::span(&out[std::size_t(k)], 1));
  });
  return out;
}

// What a texel takes where rows are filled, which is less than what it takes alone.
double seconds_in_rows(const Sampler& sampler, const Target& target) {
  constexpr int rows = 16, most = 256;
  const auto start = std::chrono::steady_clock::now();
  std::atomic<std::size_t> count = 0;
  parallel_for(rows, [&](int k) {
    const int row = (2 * k + 1) * target.size / (2 * rows);
    const Columns in = columns(target.to, target.size, row);
    std::vector<Colour> out(std::min<std::size_t>(in.count(), most));
    sampler(0, row, in.first + int(in.count() - out.size()) / 2, out);
    count += out.size();
  });
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count() / double(count);
}

double largest(const Colour& c) { return std::max({c.x, c.y, c.z}); }

// Every k-th texel of those that carry weight, in the order of faces and rows.
std::vector<Texel> every(std::int64_t count, Projection p, int size) {
  std::vector<Texel> found;
  std::int64_t all = 0;
  for (int row = 0; row < size; ++row) all += columns(p, size, row).end - columns(p, size, row).first;
  all *= faces(p);
  const double step = std::max(1.0, double(all) / double(count));
  double next = 0.5 * step;
  std::int64_t index = 0;
  for (int face = 0; face < faces(p); ++face)
    for (int row = 0; row < size; ++row) {
      const Columns in = columns(p, size, row);
      for (; next < double(index + in.end - in.first); next += step)
        found.push_back({face, in.first + int(next - double(index)), row});
      index += in.end - in.first;
    }
  return found;
}

// The mean of what lies around the middle of each texel, over an area that holds the texel and all that is interpolated
// in it.
std::vector<Colour> around(const std::vector<PaddedLevel>& levels, const Target& target,
                           std::span<const Texel> texels) {
  const PaddedLevel& base = levels.front();
  const double coarser =
      0.5 * portable::log2(texel_count(base.projection(), base.height()) / texel_count(target.to, target.size));
  const auto level = std::min(levels.size() - 1, 2 + std::size_t(std::max(0.0, std::floor(coarser))));
  return sampled(make_sampler(std::span(levels).subspan(level), target, {Filter::bilinear, 1}), texels);
}

// The texels in which one sample and 2 x 2 differ most, for the light that is wrong and for their own radiance, and
// those that lie dark beside a light, which samples may miss.
std::vector<Texel> hardest(const std::vector<PaddedLevel>& levels, const Target& target, double floor) {
  const std::vector<Texel> texels = every(searched, target.to, target.size);
  const std::vector<Colour> one = sampled(make_sampler(levels, target, {Filter::bilinear, 1}), texels);
  const std::vector<Colour> four = sampled(make_sampler(levels, target, {Filter::bilinear, 2}), texels);
  std::vector<Texel> found;
  std::vector<std::pair<double, std::size_t>> order(texels.size());
  const auto take = [&](std::size_t count, auto error) {
    for (std::size_t k = 0; k < texels.size(); ++k) order[k] = {-error(k), k};
    count = std::min(count, order.size());
    std::ranges::partial_sort(order, order.begin() + std::ptrdiff_t(count));
    for (std::size_t k = 0; k < count; ++k) found.push_back(texels[order[k].second]);
  };
  take(brightest, [&](std::size_t k) { return double(largest(glm::abs(one[k] - four[k]))); });
  take(worst,
       [&](std::size_t k) { return largest(glm::abs(one[k] - four[k])) / std::max<double>(largest(four[k]), floor); });
  const std::vector<Colour> all = around(levels, target, texels);
  take(beside_lights, [&](std::size_t k) { return largest(all[k]) / std::max<double>(largest(four[k]), floor); });
  return found;
}

// Solid angles up to a common factor. Rim texels with their centre outside the disc get almost no weight.
std::vector<double> weights(const Target& target, std::span<const Texel> texels) {
  std::vector<Point2> centres;
  for (const Texel& t : texels)
    centres.push_back({(t.i + 0.5) / (target.size * aspect(target.to)), (t.j + 0.5) / target.size});
  std::vector<double> found(texels.size());
  densities(target.to, centres, found);
  return found;
}

// The metrics of compare(). For rms the brightest texels stand for themselves and the first `even`, spread over the
// map, for `share` each: most of the power of a map with a sun is in a few texels.
FilterTrial measured(const Candidate& candidate, std::span<const Colour> result, std::span<const Colour> truth,
                     std::span<const double> weights, std::size_t even, double share, double floor) {
  FilterTrial t{candidate.filter, candidate.samples, 0, 0, 0};
  CompensatedSum error, power;
  for (std::size_t k = 0; k < truth.size(); ++k)
    for (int c = 0; c < 3; ++c) {
      const double a = result[k][c], b = truth[k][c], off = std::abs(a - b);
      const double w = weights[k] * (k < even ? share : k < even + brightest ? 1 : 0);
      error.add(w * off * off);
      power.add(w * b * b);
      if (off > 0) t.maximum = std::max(t.maximum, off / std::max(b, floor));
    }
  t.rms = power.value() > 0 ? std::sqrt(error.value() / power.value()) : std::sqrt(error.value());
  return t;
}

}  // namespace

FilterChoice choose_filter(const std::vector<PaddedLevel>& levels, const Target& target, double max_error,
                           double floor) {
  std::vector<Texel> texels = every(std::int64_t(spread), target.to, target.size);
  texels.resize(std::min(texels.size(), spread));
  const std::size_t even = texels.size();
  std::ranges::copy(hardest(levels, target, floor), std::back_inserter(texels));
  const std::vector<double> w = weights(target, texels);
  const double all = texel_count(target.to, target.size);
  const double share = std::max(1.0, all / double(even));
  const auto truth =
      sampled(make_sampler(levels, target, {Filter::area, 1, std::max(1e-7, 0.1 * max_error), floor}), texels);

  FilterChoice choice{.filter = {}, .trials = {}, .texels = std::int64_t(texels.size()), .reached = false};
  const auto attempt = [&](const Candidate& candidate) {
    choice.filter = {candidate.filter, candidate.samples, std::max(1e-7, 0.25 * max_error), floor, AreaSides::quads};
    const auto start = std::chrono::steady_clock::now();
    const Sampler sampler = make_sampler(levels, target, choice.filter);
    const std::chrono::duration<double> making = std::chrono::steady_clock::now() - start;
    const auto result = sampled(sampler, texels);
    FilterTrial trial = measured(candidate, result, truth, w, even, share, floor);
    trial.seconds_per_texel = making.count() / all + seconds_in_rows(sampler, target);
    choice.trials.push_back(trial);
    choice.reached = trial.rms <= max_error && trial.maximum <= max_error;
    return choice.reached;
  };
  for (const Candidate& candidate : candidates)
    if (attempt(candidate)) return choice;
  attempt({Filter::area, 1});
  return choice;
}

}  // namespace envmap
