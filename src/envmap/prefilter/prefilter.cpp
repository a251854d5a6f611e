#include "envmap/prefilter/prefilter.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <memory>

#include "envmap/base/error.h"
#include "envmap/operate/convert.h"
#include "envmap/operate/measure.h"
#include "envmap/base/parallel.h"
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

void scale(Level& level, double factor) {
  if (factor == 1) return;
  for_each_row(level.faces(), level.height(), {}, [&](int face, int row) {
    for (Colour& c : level.row(face, row)) c = Colour(factor * Flux(c));
  });
}

// What one light may be off, over the error that their sum then has: measured on probes. Where the horizon bends or
// breaks the lobe, errors of lights are not as independent as elsewhere.
double first_guess(const Lobe& lobe) {
  const double edge = at_horizon(lobe), low = std::visit([](const auto&l) { return l.value(0.9); }, lobe);
  return edge > bent ? 0.07 : edge > steep ? 0.3 : low > 1e-3 ? 0.8 : 3;
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

// A lobe that is bent at the horizon cuts so many texels that for small errors in small maps all are sooner summed up.
bool exact_is_cheaper(const EnvironmentMap& source, const Prefilter& p, const Lobe& lobe) {
  const double lights = 1.0 * source.base().width() * source.base().height() * source.base().faces();
  const double edge = at_horizon(lobe), least = edge > broken ? 2e-3 : edge > bent ? 5e-4 : 0;
  return p.max_error < least && texels_of(p) * lights < 2e8;
}

// What --scale makes of a normalised lobe.
double factor(const Prefilter& p) {
  if (!p.scale) return 1;
  return p.shape == Shape::phong ? *p.scale * 2 * pi / (p.parameter + 1) : *p.scale;
}

// ---- one map in the making --------------------------------------------------------------------------------------------

struct Making {
  const EnvironmentMap& source;
  const LightTree& tree;
  std::unique_ptr<Spectrum>& spectrum;
  const Prefilter& wanted;
  const Lobe lobe;
  const Target target;
  const Progress& progress;

  // make(level, doubt) fills a level of the target.
  template <class Make>
  [[nodiscard]] Prefiltered timed(Method method, Make&& make) const {
    const auto start = std::chrono::steady_clock::now();
    std::vector<float> doubt;
    Prefiltered done{.map = {}, .method = method};
    done.map.levels.emplace_back(wanted.to, wanted.size);
    done.map.forward = wanted.forward;
    make(done.map.base(), doubt);
    done.seconds = seconds_since(start);
    if (method == Method::exact) return done;
    const Verified found = verify(tree, lobe, target, done.map.base(), doubt, std::max(finest, wanted.max_error));
    done.error = found.error, done.directions = found.directions;
    done.reached = done.error <= wanted.max_error;
    return done;
  }

  [[nodiscard]] Prefiltered exact() const {
    return timed(Method::exact,
                 [&](Level& out, auto&) { exact_texels(source.base(), lobe, target, texels_of(out), out, progress); });
  }
  [[nodiscard]] Prefiltered mirror() const {
    return timed(Method::exact, [&](Level& out, auto&) {
      const ConvertOptions nearest{
          .to = {wanted.to, wanted.forward}, .size = wanted.size, .filter = Filter::nearest};
      out = std::move(convert(source, nearest).base());
    });
  }
  [[nodiscard]] Prefiltered harmonics() const {
    return timed(Method::sh, [&](Level& out, auto&) {
      std::vector<double> factors = zonal(lobe, wanted.order > 0 ? wanted.order : 32);
      while (wanted.order == 0 && factors.size() > 3 && std::abs(factors.back()) < 1e-3 * wanted.max_error)
        factors.pop_back();
      Harmonics h = project(source, static_cast<int>(factors.size()) - 1, progress);
      scale_degrees(h, factors);
      out = std::move(evaluate(h, wanted.to, wanted.size, wanted.forward).base());
    });
  }

  [[nodiscard]] Prefiltered hierarchical(double accuracy) const {
    return timed(Method::hierarchical, [&](Level& out, auto& doubt) {
      doubt = hierarchical_prefilter(tree, lobe, target, {accuracy}, out, progress);
    });
  }
  [[nodiscard]] Prefiltered refined() const {
    double accuracy = wanted.max_error * first_guess(lobe);
    Prefiltered done = hierarchical(accuracy);
    // Texels that were not looked at may be worse, most of all under an edge at the horizon: they are left room.
    const double room = at_horizon(lobe) > bent ? 0.4 : 0.7;
    for (int round = 0; round < 7 && done.error > room * wanted.max_error; ++round) {
      accuracy *= std::clamp(0.4 * wanted.max_error / done.error, 0.02, 0.5);
      done = hierarchical(accuracy);
    }
    return done;
  }

  [[nodiscard]] Prefiltered spectral(const std::vector<double>& factors, double error) const {
    return timed(Method::spectral, [&](Level& out, auto&) {
      const int order = static_cast<int>(factors.size()) - 1;
      if (!spectrum || spectrum->order() < order || spectrum->error() > error)
        spectrum = std::make_unique<Spectrum>(source.base(), factors, error, progress);
      spectrum->convolve(factors, target, out, progress);
    });
  }
  [[nodiscard]] Prefiltered spectral() const {
    const std::vector<double> all = zonal(lobe, most_spectral_order);
    const std::vector<double> factors = spectral_factors(all, spectral_tail(tree, wanted.max_error));
    return spectral(factors.empty() ? all : factors, wanted.max_error);
  }
  // Nothing where it takes more degrees than there are, or than there are texels.
  [[nodiscard]] std::optional<Prefiltered> spectral_if_cheaper() const {
    if (!may_be_spectral(wanted, lobe)) return std::nullopt;
    const std::vector<double> all = zonal(lobe, most_spectral_order);
    std::vector<double> factors;
    for (const double error : {wanted.max_error, wanted.max_error / 10}) {
      if (const auto found = spectral_factors(all, spectral_tail(tree, error)); !found.empty()) factors = found;
      if (factors.empty() || texels_of(wanted) < std::pow(static_cast<double>(factors.size()), 2)) break;
      if (Prefiltered done = spectral(factors, error); done.error <= 0.7 * wanted.max_error) return done;
    }
    return std::nullopt;
  }

  [[nodiscard]] Prefiltered automatic() const {
    if (wanted.max_error < finest || exact_is_cheaper(source, wanted, lobe)) return exact();
    if (std::optional<Prefiltered> done = spectral_if_cheaper()) return std::move(*done);
    Prefiltered done = refined();
    return done.reached ? std::move(done) : exact();
  }
  [[nodiscard]] Prefiltered made() const {
    if (is_mirror(wanted)) return mirror();
    switch (wanted.method) {
      case Method::exact: return exact();
      case Method::hierarchical: return refined();
      case Method::spectral: return spectral();
      case Method::sh: return harmonics();
      case Method::automatic: break;
    }
    return automatic();
  }
};

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
  const Rotation turn = glm::transpose(image_to_world(map_.forward)) * image_to_world(wanted.forward);
  const Making making{map_,    prepared_->tree, prepared_->spectrum,
                      wanted,  lobe_of(wanted), {wanted.to, wanted.size, turn},
                      progress};
  Prefiltered done = making.made();
  scale(done.map.base(), factor(wanted));
  return done;
}

}  // namespace envmap
