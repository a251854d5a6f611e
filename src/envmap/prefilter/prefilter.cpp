#include "envmap/prefilter/prefilter.h"

#include <tbb/parallel_for.h>
#include <tbb/parallel_invoke.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <limits>
#include <memory>
#include <tuple>

#include "envmap/error.h"
#include "envmap/operate/convert.h"
#include "envmap/operate/measure.h"
#include "envmap/operate/parallel.h"
#include "envmap/prefilter/exact.h"
#include "envmap/prefilter/harmonics.h"
#include "envmap/prefilter/hierarchical.h"
#include "envmap/prefilter/spectral.h"

namespace envmap {

// Small maps are blown up, which changes nothing where radiance is constant over a texel: the tree then holds their texels
// in parts small enough for any lobe's tail.
struct PrefilterSource::Prepared {
  std::optional<Level> grown;
  LightTree tree;
  mutable std::unique_ptr<Spectrum> spectrum;  // Of the largest order wanted so far.
  explicit Prepared(const Level& source);
};

namespace {

constexpr int least_height = 64;
constexpr double finest = 1e-5;  // Errors below this are left to float64.

// Nothing where the source is large enough.
std::optional<Level> grown(const Level& source) {
  if (source.height() >= least_height) return std::nullopt;
  const int times = (least_height + source.height() - 1) / source.height();
  Level out(source.projection(), source.height() * times);
  for_each_row(out.faces(), out.height(), {}, [&](int face, int j) {
    for (int i = 0; i < out.width(); ++i) *out.texel(face, i, j) = *source.texel(face, i / times, j / times);
  });
  return out;
}

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

Rotation to_source(const Prefilter& p, const EnvironmentMap& source) {
  return glm::transpose(image_to_world(source.forward)) * image_to_world(p.forward);
}

EnvironmentMap empty_map(const Prefilter& p) {
  EnvironmentMap map;
  map.levels.emplace_back(p.to, p.size);
  map.forward = p.forward;
  return map;
}

// ---- the methods ----------------------------------------------------------------------------------------------------

// Directions of a row's texels in the image frame of the source.
std::vector<Direction> row_directions(const Prefilter& p, const Rotation& turn, int face, int row) {
  const Columns in = columns(p.to, p.size, row);
  std::vector<Direction> d(static_cast<std::size_t>(in.end - in.first));
  texel_directions(p.to, p.size, face, row, in.first, d);
  rotate(turn, d);
  return d;
}

EnvironmentMap by_exact(const EnvironmentMap& source, const Prefilter& p, const Lobe& lobe, const Progress& progress) {
  EnvironmentMap map = empty_map(p);
  std::vector<Direction> all;
  std::vector<Colour*> texels;
  const Rotation turn = to_source(p, source);
  for (int face = 0; face < map.base().faces(); ++face)
    for (int row = 0; row < p.size; ++row) {
      const std::vector<Direction> d = row_directions(p, turn, face, row);
      all.insert(all.end(), d.begin(), d.end());
      for (std::size_t k = 0; k < d.size(); ++k)
        texels.push_back(map.base().texel(face, columns(p.to, p.size, row).first + static_cast<int>(k), row));
    }
  const std::vector<Flux> found = exact_prefilter(source.base(), lobe, all, progress);
  for (std::size_t k = 0; k < found.size(); ++k) *texels[k] = Colour(found[k]);
  return map;
}

EnvironmentMap by_harmonics(const EnvironmentMap& source, const Prefilter& p, const Lobe& lobe, const Progress& progress) {
  std::vector<double> factors = zonal(lobe, p.order > 0 ? p.order : 32);
  while (p.order == 0 && factors.size() > 3 && std::abs(factors.back()) < 1e-3 * p.max_error) factors.pop_back();
  Harmonics h = project(source, static_cast<int>(factors.size()) - 1, progress);
  scale_degrees(h, factors);
  return evaluate(h, p.to, p.size, p.forward);
}

EnvironmentMap by_tree(const EnvironmentMap& source, const LightTree& tree, const Prefilter& p, const Lobe& lobe,
                       double accuracy, std::vector<float>& doubt, const Progress& progress) {
  EnvironmentMap map = empty_map(p);
  const Target target{p.to, p.size, to_source(p, source)};
  doubt = hierarchical_prefilter(tree, lobe, target, {accuracy}, map.base(), progress);
  return map;
}

EnvironmentMap by_spectrum(const EnvironmentMap& source, std::unique_ptr<Spectrum>& spectrum, const Prefilter& p,
                           std::span<const double> factors, double error, const Progress& progress) {
  const int order = static_cast<int>(factors.size()) - 1;
  if (!spectrum || spectrum->order() < order || spectrum->error() > error)
    spectrum = std::make_unique<Spectrum>(source.base(), factors, error, progress);
  EnvironmentMap map = empty_map(p);
  spectrum->convolve(factors, {p.to, p.size, to_source(p, source)}, map.base(), progress);
  return map;
}

EnvironmentMap by_mirror(const EnvironmentMap& source, const Prefilter& p) {
  EnvironmentMap copy = source;
  return convert(copy, {.to = p.to, .size = p.size, .filter = Filter::nearest, .forward = p.forward});
}

// ---- the check ------------------------------------------------------------------------------------------------------

// Texels worth looking at in a result: spread evenly, the darkest, the brightest, the steepest for their own radiance, and
// those of which the method itself is least sure, if it says so.
std::vector<Texel> hardest(const Level& level, const std::vector<float>& doubt) {
  constexpr std::size_t even = 112, each = 48;
  std::vector<Texel> all;
  for (int face = 0; face < level.faces(); ++face)
    for (int j = 0; j < level.height(); ++j)
      for (int i = columns(level.projection(), level.height(), j).first;
           i < columns(level.projection(), level.height(), j).end; ++i)
        all.push_back({face, i, j});
  if (all.size() <= even + 3 * each) return all;
  std::vector<Texel> found;
  for (std::size_t k = 0; k < even; ++k) found.push_back(all[(2 * k + 1) * all.size() / (2 * even)]);
  const auto least = [&](const Texel& t) {
    const Colour& c = *level.texel(t.face, t.i, t.j);
    return std::min({c.x, c.y, c.z});
  };
  const auto most = [&](const Texel& t) {
    const Colour& c = *level.texel(t.face, t.i, t.j);
    return std::max({c.x, c.y, c.z});
  };
  const auto slope = [&](const Texel& t) {
    const Colour& c = *level.texel(t.face, t.i, t.j);
    const Colour& beside = *level.texel(t.face, t.i > 0 ? t.i - 1 : t.i, t.j > 0 ? t.j - 1 : t.j);
    const Colour off = glm::abs(c - beside) / glm::max(c, Colour(1e-30F));
    return std::max({off.x, off.y, off.z});
  };
  std::array<std::vector<Texel>, 4> hard;
  const auto take = [&](std::vector<Texel>& into, auto key) {
    std::vector<std::pair<float, std::uint32_t>> order(all.size());
    for (std::uint32_t k = 0; k < all.size(); ++k) order[k] = {key(all[k]), k};
    std::ranges::nth_element(order, order.begin() + each);
    for (std::size_t k = 0; k < each; ++k) into.push_back(all[order[k].second]);
  };
  const auto unsure = [&](const Texel& t) {
    return doubt[static_cast<std::size_t>((t.face * level.height() + t.j) * level.width() + t.i)];
  };
  tbb::parallel_invoke([&] { take(hard[0], least); }, [&] { take(hard[1], [&](const Texel& t) { return -most(t); }); },
                       [&] { take(hard[2], [&](const Texel& t) { return -slope(t); }); },
                       [&] {
                         if (!doubt.empty()) take(hard[3], [&](const Texel& t) { return -unsure(t); });
                       });
  for (const std::vector<Texel>& texels : hard) found.insert(found.end(), texels.begin(), texels.end());
  return found;
}

// The lobe just above its horizon, over its peak: 1 where it is a step (an exponent of 0), 0.03 for an exponent of 0.5.
double at_horizon(const Lobe& lobe) {
  return std::visit([](const auto& l) { return l.value(0.999) / l.value(0); }, lobe);
}
constexpr double step = 0.4, bent = 0.1;  // Exponents of 0.13 and 0.33.

// The integral in one direction; what is left out of it, as independent errors, below `bound` of it.
Flux reference(const LightTree& tree, const Lobe& lobe, const Direction& d, double bound) {
  Flux found;
  double light = 0.06 * bound;
  for (int round = 0; round < 20; ++round) {
    const double left = gather_direction(tree, lobe, {light}, d, found);
    if (left <= bound) break;
    light *= std::clamp(0.8 * bound / left, 0.01, 0.5);
  }
  return found;
}

// The largest error of a result in the texels that are hardest.
void check(const EnvironmentMap& source, const LightTree& tree, const Prefilter& p, const Lobe& lobe,
           const std::vector<float>& doubt, Prefiltered& done) {
  const Level& level = done.map.base();
  const std::vector<Texel> texels = hardest(level, doubt);
  const Rotation turn = to_source(p, source);
  const Flux floor(std::max(1e-3 * tree.mean(), std::numeric_limits<double>::min()));
  // Of a lobe that breaks off the remainders are less independent than they are taken to be.
  const double edge = at_horizon(lobe);
  const double first = edge > step ? 0.1 : edge > bent ? 0.25 : 0.5;
  const std::array bounds{first, std::min(first, 0.25)};
  std::vector<double> errors(texels.size());
  tbb::parallel_for(std::size_t{0}, texels.size(), [&](std::size_t k) {
    const Texel& t = texels[k];
    Direction d[1];
    texel_directions(p.to, p.size, t.face, t.j, t.i, d);
    // Enough where what is off and what the reference leaves out come to no more than what was asked for.
    for (const double bound : bounds) {
      const Flux truth = reference(tree, lobe, turn * d[0], bound * std::max(finest, p.max_error));
      const Flux off = glm::abs(Flux(*level.texel(t.face, t.i, t.j)) - truth) / glm::max(truth, floor);
      errors[k] = std::max({off.x, off.y, off.z});
      if (errors[k] <= (1 - bound) * p.max_error) break;
    }
  });
  done.directions = static_cast<std::int64_t>(texels.size());
  done.error = texels.empty() ? 0 : std::ranges::max(errors);
  done.reached = done.error <= p.max_error;
}

void scale(Level& level, double factor) {
  if (factor == 1) return;
  for_each_row(level.faces(), level.height(), {}, [&](int face, int row) {
    for (Colour& c : level.row(face, row)) c = Colour(factor * Flux(c));
  });
}

// What one light may be off, over the error that their sum then has: measured on probes. Where the horizon bends or
// breaks the lobe, errors of lights are not as independent as elsewhere.
double first_guess(const Lobe& lobe) {
  const auto value = [&](double x) { return std::visit([x](const auto& l) { return l.value(x); }, lobe); };
  return at_horizon(lobe) > bent ? 0.07 : value(0.9) > 1e-3 ? 0.3 : 1.5;
}

// How far the brightest block may be off anywhere by what is left out of its spectrum, for a flux of 1.
double spectral_tail(const LightTree& tree, double error) {
  double brightest = 0;
  for (const Light& l : tree.blocks(tree.first()).all())
    brightest = std::max<double>({brightest, l.flux[0], l.flux[1], l.flux[2]});
  return brightest > 0 ? 3e-4 * error / brightest : 1;
}

double texels_of(const Prefilter& p) { return 1.0 * p.size * p.size * aspect(p.to) * faces(p.to); }

// Whether a spectrum may be cheaper than the tree: for many texels, of a lobe that is not bent at its horizon, which would
// take more degrees than there are.
bool may_be_spectral(const Prefilter& p, const Lobe& lobe) {
  return texels_of(p) >= 2000 && std::visit([](const auto& l) { return l.value(0.9) <= 1e-2; }, lobe);
}

// A step at the horizon cuts so many texels that for small errors in small maps all of them are sooner summed up.
bool exact_is_cheaper(const EnvironmentMap& source, const Prefilter& p, const Lobe& lobe) {
  const double texels = 1.0 * p.size * p.size * aspect(p.to) * faces(p.to);
  const double lights = 1.0 * source.base().width() * source.base().height() * source.base().faces();
  return p.max_error < 5e-4 && at_horizon(lobe) > bent && texels * lights < 2e8;
}

// What --scale makes of a normalised lobe.
double factor(const Prefilter& p) {
  if (!p.scale) return 1;
  return p.shape == Shape::phong ? *p.scale * 2 * pi / (p.parameter + 1) : *p.scale;
}

}  // namespace

PrefilterSource::Prepared::Prepared(const Level& source)
    : grown(envmap::grown(source)), tree(grown ? *grown : source) {}

Lobe lobe_of(const Prefilter& p) {
  switch (p.shape) {
    case Shape::diffuse: return Cosine{};
    case Shape::phong:
      if (!(p.parameter >= 0 && p.parameter <= 1e9)) throw UsageError("a Phong exponent is from 0 to 1e9");
      return p.parameter == 1 ? Lobe(Cosine{}) : Lobe(Phong{p.parameter});
    case Shape::ggx: break;
  }
  if (!(p.parameter >= 0 && p.parameter <= 1)) throw UsageError("a roughness is from 0 to 1");
  return Ggx(p.parameter);
}

PrefilterSource::PrefilterSource(const EnvironmentMap& map)
    : map_(map), prepared_(std::make_unique<Prepared>(map.base())) {}
PrefilterSource::~PrefilterSource() = default;

Prefiltered PrefilterSource::make(const Prefilter& wanted, const Progress& progress) const {
  const Lobe lobe = lobe_of(wanted);
  const LightTree& tree = prepared_->tree;
  const auto timed = [&](Method method, auto&& make) {
    const auto start = std::chrono::steady_clock::now();
    std::vector<float> doubt;
    Prefiltered done{.map = make(doubt), .method = method};
    done.seconds = seconds_since(start);
    if (method != Method::exact) check(map_, tree, wanted, lobe, doubt, done);
    return done;
  };
  const auto exact = [&] { return timed(Method::exact, [&](auto&) { return by_exact(map_, wanted, lobe, progress); }); };
  const auto hierarchical = [&](double accuracy) {
    return timed(Method::hierarchical,
                 [&](auto& doubt) { return by_tree(map_, tree, wanted, lobe, accuracy, doubt, progress); });
  };
  const auto refined = [&] {
    double accuracy = wanted.max_error * first_guess(lobe);
    Prefiltered done = hierarchical(accuracy);
    // Texels that were not looked at may be worse, most of all under an edge at the horizon: they are left room.
    const bool edged = at_horizon(lobe) > bent;
    const auto room = [&](int round) { return edged ? 0.4 : round == 0 ? 0.7 : 1; };
    for (int round = 0; round < 7 && done.error > room(round) * wanted.max_error; ++round) {
      accuracy *= std::clamp(0.4 * wanted.max_error / done.error, 0.02, 0.5);
      done = hierarchical(accuracy);
    }
    return done;
  };
  const auto spectral = [&](const std::vector<double>& factors, double error) {
    return timed(Method::spectral,
                 [&](auto&) { return by_spectrum(map_, prepared_->spectrum, wanted, factors, error, progress); });
  };
  const auto make = [&]() -> Prefiltered {
    switch (wanted.method) {
      case Method::exact: return exact();
      case Method::hierarchical: return refined();
      case Method::spectral: {
        const std::vector<double> all = zonal(lobe, most_spectral_order);
        const std::vector<double> factors = spectral_factors(all, spectral_tail(tree, wanted.max_error));
        return spectral(factors.empty() ? all : factors, wanted.max_error);
      }
      case Method::sh: return timed(Method::sh, [&](auto&) { return by_harmonics(map_, wanted, lobe, progress); });
      case Method::automatic: break;
    }
    if (wanted.max_error < finest || exact_is_cheaper(map_, wanted, lobe)) return exact();
    if (may_be_spectral(wanted, lobe)) {
      const std::vector<double> all = zonal(lobe, most_spectral_order);
      std::vector<double> factors;
      for (const double error : {wanted.max_error, wanted.max_error / 10}) {
        if (const auto found = spectral_factors(all, spectral_tail(tree, error)); !found.empty()) factors = found;
        if (factors.empty() || texels_of(wanted) < std::pow(static_cast<double>(factors.size()), 2)) break;
        if (Prefiltered done = spectral(factors, error); done.error <= 0.7 * wanted.max_error) return done;
      }
    }
    Prefiltered done = refined();
    return done.reached ? std::move(done) : exact();
  };
  Prefiltered done = is_mirror(wanted) ? timed(Method::exact, [&](auto&) { return by_mirror(map_, wanted); }) : make();
  scale(done.map.base(), factor(wanted));
  return done;
}

}  // namespace envmap
