#include "envmap/prefilter/prefilter.h"

#include <fmt/format.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <functional>
#include <iterator>
#include <limits>
#include <map>
#include <memory>
#include <mutex>
#include <utility>

#include "envmap/base/carry_out.h"
#include "envmap/base/error.h"
#include "envmap/base/parallel.h"
#include "envmap/base/part_progress.h"
#include "envmap/map/atlas.h"
#include "envmap/operate/convert.h"
#include "envmap/operate/measure.h"
#include "envmap/operate/refuse_flaws.h"
#include "envmap/prefilter/exact.h"
#include "envmap/prefilter/harmonics.h"
#include "envmap/prefilter/hinge_map.h"
#include "envmap/prefilter/multilevel.h"
#include "envmap/prefilter/sheen_sum.h"
#include "envmap/prefilter/source.h"
#include "envmap/prefilter/treecode.h"

namespace envmap {

using namespace prefiltering;

namespace {

constexpr double finest = 1e-5;  // Errors below this are left to float64.

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

void scale(Level& level, double factor) {
  if (factor == 1) return;
  for_each_row(level.faces(), level.height(), {}, [&](int face, int row) {
    for (Colour& c : level.row(face, row)) c = Colour(factor * Flux(c));
  });
}

// What --scale makes of a normalised lobe.
double factor(const Prefilter& p) {
  if (!p.scale) return 1;
  return p.shape == Shape::phong ? *p.scale * 2 * pi / (p.parameter + 1) : *p.scale;
}

// What a mirror shows: the source's own texels, or its mean over each texel where the result has others.
void make_mirror(const EnvironmentMap& source, const Prefilter& p, Prefiltered& done) {
  ConvertOptions how{.to = {p.to, p.forward}, .size = p.size};
  done.resampled = Filter::nearest;
  if (!keeps_texels(source, how)) {
    done.error = p.method == Method::exact ? finest : std::clamp(p.max_error, finest, 1e-2);
    done.resampled = how.filter = Filter::area;
    // Its tolerance is not a bound where a side cuts a sun in two: choose_filter.h.
    how.area_error = 0.25 * done.error;
  }
  const Rows rows = Resampler(source, how).rows();
  done.map.forward = rows.forward;
  done.map.base() = level_of(some_rows(rows, p.rows));
}

}  // namespace

struct PrefilterSource::Prepared {
  const std::optional<EnvironmentMap> taken;  // The map itself, where it was given away.
  const std::optional<EnvironmentMap> cube;
  const EnvironmentMap& source;
  const Totals light;
  const std::optional<Level> fine;
  // Made when they are wanted first.
  mutable std::optional<Colour> least;
  mutable std::optional<Tree> tree;
  mutable std::optional<Hinges> hinges;       // Of the order and error wanted last.
  mutable std::map<int, SourceGrids> grids;   // By the rows of the finest: no result depends on earlier ones.
  mutable std::map<int, SheenBlocks> blocks;  // By rows of texels.
  mutable std::mutex in_use;                  // By the one make() that runs.

  Prepared(std::optional<EnvironmentMap>&& given, const EnvironmentMap* lent)
      : taken(std::move(given)),
        cube(source_cube(require_finite(taken ? *taken : *lent))),
        source(cube    ? *cube
               : taken ? *taken
                       : *lent),
        light(totals(source.base())),
        fine(refined(source.base())) {}

  // In texels of 1.5 degrees or less.
  [[nodiscard]] const Level& small_texels() const { return fine ? *fine : source.base(); }
  [[nodiscard]] const Colour& darkest() const {
    if (!least) least = darkest_of(source.base());
    return *least;
  }
  [[nodiscard]] const Tree& nodes() const {
    if (!tree) tree.emplace(small_texels(), light.mean, small_texels().height() / source.base().height());
    return *tree;
  }
  [[nodiscard]] const Hinges& sums(int order, double error) const {
    if (!hinges || !hinges->fits(order, error)) hinges.emplace(small_texels(), light.mean, darkest(), order, error);
    return *hinges;
  }
  [[nodiscard]] const SourceGrids& levels(int finest) const {
    return grids.try_emplace(finest, source.base(), light.mean, darkest(), finest).first->second;
  }
  [[nodiscard]] const SheenBlocks& sheen(double texel) const {
    const std::optional<Level> finer = refined(source.base(), texel);
    const Level& texels = finer ? *finer : source.base();
    return blocks.try_emplace(texels.height(), texels, light.mean, darkest()).first->second;
  }
};

namespace {

// ---- one map in the making ------------------------------------------------------------------------------------------

struct Making {
  const Level& source;
  const Level& small_texels;
  const Totals& light;
  const std::function<const Tree&()> tree;
  const std::function<const Hinges&(int order)> hinges;
  const std::function<const SourceGrids&(int finest)> grids;
  const std::function<const Colour&()> darkest;
  const std::function<const SheenBlocks&(double texel)> sheen;
  const Prefilter& wanted;
  const Lobe lobe;
  const Target target;
  const Progress& progress;

  [[nodiscard]] bool is_wanted(const Texel& t) const {
    return wanted.rows.empty() || wanted.rows[std::size_t(t.face * wanted.size + t.j)] != 0;
  }

  // What is decided for the map is decided from all of it; what is then made are the rows wanted.
  void make(Prefiltered& done) const {
    Level& out = done.map.base();
    std::vector<Texel> all = texels_of(out);
    std::erase_if(all, [&](const Texel& t) { return !is_wanted(t); });
    const bool any = wanted.method == Method::automatic;
    if (wanted.method == Method::exact || wanted.max_error < finest) {
      exact_texels(source, lobe, target, all, out, progress);
      done.method = Method::exact, done.exact = std::int64_t(all.size());
      return;
    }
    std::vector<float> figures(index_of(out, {out.faces(), 0, 0}), std::numeric_limits<float>::infinity());
    if (const auto weight = hinge_polynomial(lobe);
        weight && (any || wanted.method == Method::prefix_sums || wanted.method == Method::multilevel)) {
      if (light.mean > 0)
        hinge_map(hinges(weight->order()), *weight, target, wanted.max_error, light.mean, wanted.rows, out, figures,
                  progress);
      else
        std::ranges::fill(figures, 0.F);
      done.method = Method::prefix_sums;
      finish(all, figures, out, done);
      return;
    }
    if (any || wanted.method == Method::multilevel)
      if (const auto plan = multilevel_plan(lobe, wanted.max_error, finest_rows(source));
          plan && serves_multilevel(source) &&
          (!any || plan->is_quick(source, texels_of(out).size(), wanted.max_error))) {
        make_multilevel(*plan, out, figures);
        done.method = Method::multilevel;
        finish(all, figures, out, done);
        return;
      }
    if (const auto plan = sheen_plan(lobe, wanted.max_error);
        plan && (any ? plan->is_quick(wanted.max_error) : wanted.method == Method::multilevel)) {
      if (light.mean > 0)
        sheen_map(*plan, sheen(plan->texel()), light.mean, target, wanted.rows, out, figures, progress);
      else
        std::ranges::fill(figures, 0.F);
      done.method = Method::multilevel;
      finish(all, figures, out, done);
      return;
    }
    done.method = Method::hierarchical;
    treecode_prefilter(tree(), lobe, target, wanted.max_error, wanted.rows, out, figures, progress);
    finish(all, figures, out, done);
  }

  void make_multilevel(const MultilevelPlan& plan, Level& out, std::span<float> figures) const {
    if (light.mean <= 0) return void(std::ranges::fill(figures, 0.F));
    const MultilevelSource from{small_texels, grids(plan.finest()),
                                plan.has_hinges() ? &hinges(plan.hinges.order()) : nullptr, light.mean, darkest()};
    multilevel_map(plan, from, target, wanted.rows, out, figures, progress);
  }

  // Sums what is not known well enough, and says how well the rest is.
  void finish(const std::vector<Texel>& all, std::span<const float> figures, Level& out, Prefiltered& done) const {
    std::vector<Texel> left;
    for (const Texel& t : all)
      if (const float figure = figures[index_of(out, t)]; figure > float(wanted.max_error))
        left.push_back(t);
      else
        done.error = std::max<double>(done.error, figure);
    exact_texels(source, lobe, target, left, out, progress);
    done.exact = std::int64_t(left.size());
    if (left.size() == all.size()) done.method = Method::exact;
  }
};

}  // namespace

std::string_view method_name(const Prefiltered& done) {
  return done.resampled ? name(*done.resampled) : method_names[std::size_t(done.method)];
}

namespace {

void check(const Prefilter& p) {
  check(limits::size, p.size);
  check(limits::max_error, p.max_error);
  if (p.scale) check(limits::scale, *p.scale);
  const std::size_t rows = std::size_t(faces(p.to)) * std::size_t(p.size);
  if (!p.rows.empty() && p.rows.size() != rows)
    throw UsageError(
        fmt::format("rows must be empty or {} flags, one for each row of each face, not {}", rows, p.rows.size()));
  (void)lobe_of(p);
}

Lobe lobe_by_shape(const Prefilter& p) {
  if (p.shape == Shape::phong || p.shape == Shape::blinn_phong) check(limits::exponent, p.parameter);
  switch (p.shape) {
    case Shape::diffuse: return Cosine{};
    case Shape::phong: return p.parameter == 1 ? Lobe(Cosine{}) : Lobe(Phong{p.parameter});
    case Shape::blinn_phong: return p.parameter == 0 ? Lobe(Cosine{}) : Lobe(BlinnPhong(p.parameter));
    case Shape::ggx:
    case Shape::charlie: break;
  }
  check(limits::roughness, p.parameter);
  if (p.shape == Shape::ggx) return Ggx(p.parameter);
  return Charlie(p.parameter);
}

}  // namespace

Lobe lobe_of(const Prefilter& p) {
  const Lobe lobe = lobe_by_shape(p);
  if (p.method == Method::prefix_sums && !is_mirror(p) && !hinge_polynomial(lobe))
    throw UsageError("prefix sums make diffuse maps, phong of exponent 1, 2 or 3 and ggx of roughness 1");
  if (p.method == Method::multilevel && !is_mirror(p) && !hinge_polynomial(lobe) &&
      !multilevel_plan(lobe, p.max_error) && !sheen_plan(lobe, p.max_error))
    throw UsageError(
        "multilevel sums make diffuse maps, phong of exponent 1, 2, 3 and from 4, blinn-phong from 2, ggx, and charlie "
        "up to roughness 0.35, for errors from 1e-4");
  return lobe;
}

PrefilterSource::PrefilterSource(const EnvironmentMap& map)
    : prepared_(std::make_unique<Prepared>(std::nullopt, &map)) {}
PrefilterSource::PrefilterSource(EnvironmentMap&& map)
    : prepared_(std::make_unique<Prepared>(std::move(map), nullptr)) {}
PrefilterSource::~PrefilterSource() = default;

const EnvironmentMap& PrefilterSource::source() const { return prepared_->source; }

Prefiltered PrefilterSource::make(const Prefilter& wanted, const Run& run) const {
  check(wanted);
  return carry_out(run, [&](const Progress& progress) { return make_now(wanted, progress); });
}

Prefiltered PrefilterSource::make_now(const Prefilter& wanted, const Progress& progress) const {
  const auto start = std::chrono::steady_clock::now();
  const EnvironmentMap& from = source();
  Prefiltered done{.map = {}, .method = Method::exact};
  done.map.levels.emplace_back(wanted.to, wanted.size);
  done.map.forward = has_forward(wanted.to) ? wanted.forward : Forward::plus_z;
  if (is_mirror(wanted)) {
    make_mirror(from, wanted, done);
  } else {
    const Rotation turn = glm::transpose(image_to_world(from.forward)) * image_to_world(done.map.forward);
    const Prepared& p = *prepared_;
    const std::lock_guard turn_of_this_thread(p.in_use);
    // While the lock is held this thread takes no task of the caller's, which might want the lock again.
    tbb::this_task_arena::isolate([&] {
      Making{from.base(),
             p.small_texels(),
             p.light,
             [&]() -> const Tree& { return p.nodes(); },
             [&](int order) -> const Hinges& { return p.sums(order, wanted.max_error); },
             [&](int finest) -> const SourceGrids& { return p.levels(finest); },
             [&]() -> const Colour& { return p.darkest(); },
             [&](double texel) -> const SheenBlocks& { return p.sheen(texel); },
             wanted,
             lobe_of(wanted),
             {wanted.to, wanted.size, turn},
             progress}
          .make(done);
    });
  }
  done.seconds = seconds_since(start);
  done.floor = 1e-3 * prepared_->light.mean * factor(wanted);
  scale(done.map.base(), factor(wanted));
  return done;
}

PrefilteredChain PrefilterSource::make_chain(const Prefilter& base, std::span<const double> parameters,
                                             const Run& run) const {
  if (parameters.empty()) throw UsageError("parameters must not be empty: a chain has a level for each");
  if (!base.rows.empty()) throw UsageError("rows must be empty: a chain is made whole");
  std::vector<Prefilter> wanted(parameters.size(), base);
  double texels = 0;
  for (std::size_t k = 0; k < wanted.size(); ++k) {
    wanted[k].parameter = parameters[k];
    if (k > 0) wanted[k].size = std::max(1, wanted[k - 1].size / 2);
    check(wanted[k]);
    texels += texel_count(base.to, wanted[k].size);
  }
  return carry_out(run, [&](const Progress& progress) {
    PrefilteredChain chain{.map = {.levels = {}, .forward = {}}, .levels = {}};
    double done = 0;
    for (const Prefilter& level : wanted) {
      const double part = texel_count(level.to, level.size);
      Prefiltered made = make_now(level, part_progress(progress, done / texels, part / texels));
      chain.map.forward = made.map.forward;
      chain.map.levels.push_back(std::move(made.map.base()));
      made.map = {};
      chain.levels.push_back(std::move(made));
      done += part;
    }
    return chain;
  });
}

}  // namespace envmap
