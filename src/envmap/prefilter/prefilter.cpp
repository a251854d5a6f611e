#include "envmap/prefilter/prefilter.h"

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
#include "envmap/prefilter/verify.h"

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
    if (method != Method::exact) {
      const Target target{wanted.to, wanted.size, to_source(wanted, map_)};
      const Verified found = verify(tree, lobe, target, done.map.base(), doubt, std::max(finest, wanted.max_error));
      done.error = found.error, done.directions = found.directions;
      done.reached = done.error <= wanted.max_error;
    }
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
