// Prefilterer: checks the options, chooses a method, makes the map, and sums the texels exactly whose bounds exceed
// the error that was asked for.
#include "envmap/prefilter/prefilter.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <memory>
#include <utility>

#include "envmap/base/error.h"
#include "envmap/base/parallel.h"
#include "envmap/base/part_progress.h"
#include "envmap/base/run_operation.h"
#include "envmap/base/turn.h"
#include "envmap/map/atlas.h"
#include "envmap/map/check_chain.h"
#include "envmap/operate/convert.h"
#include "envmap/operate/measure.h"
#include "envmap/operate/refuse_flaws.h"
#include "envmap/prefilter/choose_method.h"
#include "envmap/prefilter/error_floor.h"
#include "envmap/prefilter/exact/exact.h"
#include "envmap/prefilter/lobe_formulas.h"
#include "envmap/prefilter/prefix_sums/prefix_sums.h"
#include "envmap/prefilter/prepared_source.h"
#include "envmap/prefilter/sheen/sheen.h"
#include "envmap/prefilter/tabulated/tabulated_map.h"
#include "envmap/prefilter/treecode/treecode.h"
#include "envmap/prefilter/work_counters.h"

namespace envmap {

using namespace prefiltering;

namespace {

constexpr double finest = 1e-5;  // Smaller errors take the exact sum.

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

std::vector<StepCount> steps_since(const WorkDone& before) {
  std::vector<StepCount> steps;
  const WorkDone now = work_done();
  for (std::size_t k = 0; k < now.size(); ++k)
    if (now[k] > before[k]) steps.push_back({work_names[k], now[k] - before[k]});
  return steps;
}

void scale(Level& level, double factor) {
  if (factor == 1) return;
  for_each_row(level.faces(), level.height(), {}, [&](int face, int row) {
    for (Colour& c : level.row(face, row)) c = Colour(factor * Flux(c));
  });
}

// The factor of Prefilter::scale over a normalised lobe.
double factor(const PrefilterOptions& p) {
  if (!p.scale) return 1;
  return p.lobe.shape() == LobeShape::phong ? *p.scale * 2 * pi / (p.lobe.parameter() + 1) : *p.scale;
}

// A mirror shows the texels of the source, or its mean over each texel where the result has another grid.
void make_mirror(const EnvironmentMap& source, const PrefilterOptions& p, Prefiltered& done) {
  ConvertOptions how{.to = {p.to, p.forward}, .size = p.size};
  done.resampled = Filter::nearest;
  if (!keeps_texels(source, how)) {
    done.error = p.method == Method::exact ? finest : std::clamp(p.max_error, finest, 1e-2);
    done.resampled = how.filter = Filter::area;
    // The tolerance of an outline is not a bound where a side cuts a sun in two: choose_filter.h.
    how.area_error = 0.25 * done.error, how.area_sides = AreaSides::bounded_quads;
  }
  const Rows rows = Resampler(source, how).rows();
  done.map.forward = rows.forward;
  done.map.base() = level_of(some_rows(rows, p.rows));
}

// A map by the plan of each method. @param error of each texel.
struct Make {
  PreparedSource& from;
  double error;
  const TargetTexels& map;

  [[nodiscard]] const PrefixSums* prefix_sums(const ClampedCosinePolynomial& p, bool needed) const {
    return needed ? &from.prefix_sums(p.order(), error) : nullptr;
  }
  void operator()(const std::monostate&) const {}
  void operator()(const ClampedCosinePolynomial& polynomial) const {
    prefix_sums_map(*prefix_sums(polynomial, true), polynomial, error, from.light.mean, map);
  }
  void operator()(const MultilevelPlan& plan) const { multilevel_map(plan, from.multilevel(plan, error), map); }
  void operator()(const SheenPlan& plan) const { sheen_map(plan, from.sheen(plan.texel()), from.light.mean, map); }
  void operator()(const TreecodeLobe& lobe) const {
    treecode_map(from.tree(), prefix_sums(lobe.horizon_terms, lobe.has_horizon_terms()), lobe, error, map);
  }
};

// Makes a map by the wanted method, with the bounds of its texels. All decisions follow from the whole map, whatever
// rows are wanted. @param texels of the whole map. @return the method; exact where prefilter sums the texels exactly.
Method make_fast(PreparedSource& from, const PrefilterOptions& wanted, const LobeFormula& lobe, std::size_t texels,
                 const TargetTexels& map) {
  const double error = wanted.max_error;
  if (wanted.method == Method::exact || error < finest) return Method::exact;
  const Choice choice = choose(lobe, from.texels(), double(texels), error, wanted.method);
  if (from.light.mean <= 0)
    std::ranges::fill(map.bounds, 0.F);  // All is black.
  else
    std::visit(Make{from, error, map}, choice.plan);
  return choice.method;
}

bool is_table(const Lobe& lobe) { return lobe.shape() == LobeShape::table; }

// Makes a map of a table.
void make_table(PreparedSource& from, const PrefilterOptions& wanted, const TargetTexels& map, Prefiltered& done) {
  done.method = Method::treecode;
  if (from.light.mean <= 0) return;
  tabulated_map(from.tree(), TableLobe(wanted.lobe.samples()), wanted.max_error, map);
  for (const Texel& t : texels_of(map.out))
    if (map.wants(t.face, t.j)) done.error = std::max<double>(done.error, map.bounds[index_of(map.out, t)]);
  if (!(done.error <= wanted.max_error))
    throw AccuracyError(
        fmt::format("the table is summed to an error of {:.1e}, not to {:g}", done.error, wanted.max_error));
}

// Makes a map. Texels whose bounds exceed the error are summed exactly.
void make_lobe(PreparedSource& from, const PrefilterOptions& wanted, const Target& target, const Progress& progress,
               Prefiltered& done) {
  Level& out = done.map.base();
  std::vector<float> bounds(index_of(out, {out.faces(), 0, 0}), std::numeric_limits<float>::infinity());
  const TargetTexels map{target, wanted.rows, out, bounds, progress};
  if (is_table(wanted.lobe)) return make_table(from, wanted, map, done);
  const LobeFormula lobe = formula_of(wanted.lobe);
  std::vector<Texel> all = texels_of(out), left;
  done.method = make_fast(from, wanted, lobe, all.size(), map);
  std::erase_if(all, [&](const Texel& t) { return !map.wants(t.face, t.j); });
  for (const Texel& t : all)
    if (const float bound = bounds[index_of(out, t)]; !(bound <= float(wanted.max_error)))  // Too large, or NaN.
      left.push_back(t);
    else
      done.error = std::max<double>(done.error, bound);
  exact_texels(from.texels(), lobe, target, left, out, progress);
  done.exact = std::int64_t(left.size());
  if (left.size() == all.size()) done.method = Method::exact;
}

void check(const PrefilterOptions& p) {
  check_enumerator("to", p.to);
  check_enumerator("method", p.method);
  check_enumerator("forward", p.forward);
  check_range(limits::size, p.size);
  check_range(limits::max_error, p.max_error);
  if (p.scale) check_range(limits::scale, *p.scale);
  const std::size_t rows = std::size_t(faces(p.to)) * std::size_t(p.size);
  if (!p.rows.empty() && p.rows.size() != rows)
    throw UsageError(
        fmt::format("rows must be empty or {} flags, one for each row of each face, not {}", rows, p.rows.size()));
  check_method(p);
}

}  // namespace

std::string_view method_name(const Prefiltered& done) {
  return done.resampled ? name(*done.resampled) : method_names[number_of("method", done.method)];
}

void check_method(const PrefilterOptions& p) {
  if (p.lobe.is_mirror()) return;
  if (is_table(p.lobe)) {
    if (p.method != Method::automatic && p.method != Method::treecode)
      throw UsageError("tables are summed by the treecode, and by no other method");
    if (p.max_error < least_table_error)
      throw UsageError(
          fmt::format("tables are summed to errors from {:g}, not to {:g}", least_table_error, p.max_error));
    return;
  }
  const LobeFormula lobe = formula_of(p.lobe);
  if (p.method == Method::prefix_sums && !clamped_cosine_polynomial(lobe))
    throw UsageError("prefix sums make diffuse maps, phong of exponent 1, 2 or 3 and ggx of roughness 1");
  if (p.method == Method::multilevel && !clamped_cosine_polynomial(lobe) && !multilevel_plan(lobe, p.max_error) &&
      !sheen_plan(lobe, p.max_error))
    throw UsageError(
        "multilevel sums make diffuse maps, phong of exponent 1, 2, 3 and from 3.6, blinn-phong from 2, ggx, and "
        "charlie up to roughness 0.35, for errors from 1e-4");
}

Prefilterer::Prefilterer(std::shared_ptr<const EnvironmentMap> map, const Run& run)
    : prepared_(run_operation(run, [&](const Progress& progress) {
        return std::make_unique<PreparedSource>(std::move(map), progress);
      })) {}
Prefilterer::~Prefilterer() = default;
Prefilterer::Prefilterer(Prefilterer&&) noexcept = default;
Prefilterer& Prefilterer::operator=(Prefilterer&&) noexcept = default;

const EnvironmentMap& Prefilterer::source() const { return prepared_->map; }

Prefiltered Prefilterer::make(const PrefilterOptions& wanted, const Run& run) const {
  check(wanted);
  return run_operation(run, [&](const Progress& progress) { return make_now(wanted, progress); });
}

Prefiltered Prefilterer::make_now(const PrefilterOptions& wanted, const Progress& progress) const {
  const auto start = std::chrono::steady_clock::now();
  const EnvironmentMap& from = source();
  const WorkDone before = work_done();
  Prefiltered done{.map = {}, .method = Method::exact};
  done.map.levels.emplace_back(wanted.to, wanted.size);
  done.map.forward = has_forward(wanted.to) ? wanted.forward : Forward::plus_z;
  if (wanted.lobe.is_mirror()) {
    make_mirror(from, wanted, done);
  } else {
    const Rotation turn = glm::transpose(image_to_world(from.forward)) * image_to_world(done.map.forward);
    const auto turn_of_this_thread = wait_for_turn(prepared_->in_use, progress);
    // While the lock is held this thread takes no task of the caller's, which might want the lock again.
    isolate_tasks([&] { make_lobe(*prepared_, wanted, {wanted.to, wanted.size, turn}, progress, done); });
  }
  done.work = steps_since(before);
  done.seconds = seconds_since(start);
  done.floor = floor_of_mean * prepared_->light.mean * factor(wanted);
  scale(done.map.base(), factor(wanted));
  if (wanted.scale) require_no_overflow(done.map.base(), fmt::format("a scale of {:g}", *wanted.scale), "scale");
  return done;
}

PrefilteredChain Prefilterer::make_chain(std::span<const Lobe> lobes, const PrefilterOptions& base,
                                         const Run& run) const {
  if (lobes.empty()) throw UsageError("lobes must not be empty: a chain has a level for each");
  if (base.lobe.shape() != LobeShape::diffuse) throw UsageError("the lobes of a chain are those of its levels");
  if (!base.rows.empty()) throw UsageError("rows must be empty: a chain is made whole");
  std::vector<PrefilterOptions> wanted(lobes.size(), base);
  std::vector<LevelSize> sizes;
  double texels = 0;
  for (std::size_t k = 0; k < wanted.size(); ++k) {
    wanted[k].lobe = lobes[k];
    if (k > 0) wanted[k].size = std::max(1, wanted[k - 1].size / 2);
    check(wanted[k]);
    sizes.push_back({wanted[k].size * aspect(base.to), wanted[k].size});
    texels += texel_count(base.to, wanted[k].size);
  }
  check_level_count(sizes.front(), sizes.size());
  check_halving(sizes);
  return run_operation(run, [&](const Progress& progress) {
    PrefilteredChain chain{.map = {.levels = {}, .forward = {}}, .levels = {}};
    double done = 0;
    for (const PrefilterOptions& level : wanted) {
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
