#include "envmap/operate/convert.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "envmap/base/error.h"
#include "envmap/base/parallel.h"
#include "envmap/base/run_operation.h"
#include "envmap/map/check_row.h"
#include "envmap/maths/portable.h"
#include "envmap/operate/check_options.h"
#include "envmap/operate/choose_filter.h"
#include "envmap/operate/levels.h"
#include "envmap/operate/measure.h"
#include "envmap/operate/refuse_flaws.h"
#include "envmap/projection/matching_size.h"
#include "envmap/projection/visit.h"
#include "envmap/sample/sampler.h"

namespace envmap {
namespace {

// Degrees that a texel spans along the height of a face.
double pitch(Projection p, int size) {
  return visit(p, [](auto q) { return decltype(q)::span; }) / size;
}

// How many source texels a texel of the result covers, along a side.
double covered(const Target& target, const Level& source) {
  return pitch(target.to, target.size) / pitch(source.projection(), source.height());
}

void check(const ConvertOptions& o) {
  if (o.size) check_range(limits::size, *o.size);
  check_range(limits::samples, o.samples);
  if (o.area_error) check_range(limits::area_error, *o.area_error);
  if (o.max_error) check_range(limits::max_error, *o.max_error);
  check_range(limits::gain, o.gain);
  check_rotation("rotation", o.rotation);
  if (o.filter) check_enumerator("filter", *o.filter);
  if (o.area_sides) check_enumerator("area_sides", *o.area_sides);
  check_enumerator("mirror", o.mirror);
  if (o.ball) check_range({"distance", BallCamera::nearest, BallCamera::farthest}, o.ball->distance);
}

// The turn that is left of `rotation` and the mirroring where x of the result's images is negated.
Rotation turn_before_negation(const ConvertOptions& o) {
  if (o.mirror == MirroredAxis::none) return o.rotation;
  Rotation axis(1), across(1);
  axis[int(o.mirror) - 1][int(o.mirror) - 1] = -1;
  across[0][0] = -1;
  const Rotation to_world = image_to_world(o.to.forward);
  return to_world * across * glm::transpose(to_world) * axis * o.rotation;
}

Target make_target(const EnvironmentMap& source, const ConvertOptions& o) {
  check(o);
  if (o.ball && source.projection() != Projection::sphere) throw UsageError("only sphere maps are photos of a ball");
  const int size = o.size.value_or(matching_size(source.projection(), source.base().height(), o.to.projection));
  return {o.to.projection, size,
          glm::transpose(image_to_world(source.forward)) * glm::transpose(turn_before_negation(o)) *
              image_to_world(o.to.forward),
          o.ball};
}

bool same_grid(const Target& target, const Level& source) {
  return !target.ball && target.to == source.projection() && target.size == source.height() &&
         source.width() == source.height() * aspect(target.to);
}

bool is_source(const Target& target, const Level& source) {
  return same_grid(target, source) && target.to_source == Rotation(1);
}

bool near_whole(double x, double tolerance) { return std::abs(x - std::round(x)) <= tolerance; }

// Each axis becomes an axis. The angles of a turn are rounded, and so are its sines.
bool by_right_angles(const Rotation& r, double rounding) {
  for (int column = 0; column < 3; ++column)
    for (int row = 0; row < 3; ++row)
      if (!near_whole(r[column][row], rounding)) return false;
  return true;
}

// Whether a turn takes texel centres to texel centres: right angles of a cube, and of other maps where the axis of
// their images stays. The two ends of the axis change places on a latlong map, a paraboloid map and an octahedral map
// of even size, whose folds run between texels. A latlong map turns by any whole columns.
bool permutes_texels(const Target& target, const Level& source) {
  constexpr double rounding = 1e-12;
  if (!same_grid(target, source)) return false;
  const Rotation& r = target.to_source;
  if (target.to == Projection::latlong)
    return std::abs(std::abs(r[1][1]) - 1) <= rounding &&
           near_whole(portable::atan2(r[2][0], r[2][2]) / (2 * pi) * source.width(), rounding * source.width());
  if (!by_right_angles(r, rounding)) return false;
  const bool folded = is_octahedral(target.to);
  const double kept = folded ? r[1][1] : r[2][2];
  const bool ends_change = folded ? target.size % 2 == 0 : target.to == Projection::paraboloid;
  return target.to == Projection::cube || kept > 0.5 || (kept < -0.5 && ends_change);
}

bool copies_texels(const Target& target, const Level& source) {
  return is_source(target, source) || permutes_texels(target, source);
}

FilterOptions make_filter(const Target& target, const Level& source, const ConvertOptions& o) {
  FilterOptions f{.filter = o.filter.value_or(Filter::bilinear),
                  .samples = o.samples,
                  .area_error = o.area_error.value_or(1e-4),
                  .sides = o.area_sides.value_or(o.filter ? AreaSides::outlines : AreaSides::quads)};
  if (o.filter || copies_texels(target, source)) return f;
  const double covers = covered(target, source);
  if (covers > 1.25) f.filter = Filter::area, f.area_error = o.area_error.value_or(1e-3);
  if (covers > 0.5) f.samples = std::max(f.samples, 2);
  return f;
}

// Whether the filter gives a texel's own value back at its centre.
bool interpolates(const FilterOptions& f) { return f.samples == 1 && of_points(f.filter); }

// The choice where every texel of the result is one of the source.
FilterChoice exact_copy(const Target& target, const FilterOptions& filter) {
  const auto texels = std::int64_t(texel_count(target.to, target.size));
  return {.filter = filter, .trials = {{Filter::nearest, 1, 0, 0, 0}}, .texels = texels, .reached = true};
}

// Texels of the result between looks at the memory of a source in a scratch file: each place may bring in 16 pages, a
// large area more than that.
std::size_t between_trims(const Target& target, const Level& source) {
  if (source.max_memory() == 0 || is_source(target, source)) return std::numeric_limits<std::size_t>::max();
  const double covers = covered(target, source);
  return std::size_t(std::clamp(256 * 64 / (covers * covers), 1.0, 256.0));
}

}  // namespace

struct Resampler::Prepared {
  Prepared(EnvironmentMap&& source, const ConvertOptions& options);
  Prepared(const Prepared&) = delete;  // The sampler reads the levels where they lie.
  Prepared& operator=(const Prepared&) = delete;

  void fill(int face, int row, std::span<Colour> out) const;
  void copy(int face, int row, int first, std::span<Colour> out) const;

  Frame frame;
  Target target;
  FilterOptions filter;
  double gain;
  bool mirrored;
  std::optional<FilterChoice> choice;
  std::optional<Level> copied;      // The source, where its texels are the result's own and nothing is resampled.
  std::vector<PaddedLevel> levels;  // Else what the filter reads.
  Sampler sampler;
  std::size_t texels_between_trims;
};

Resampler::Prepared::Prepared(EnvironmentMap&& source, const ConvertOptions& options)
    : frame(options.to),
      target(make_target(source, options)),
      filter(make_filter(target, source.base(), options)),
      gain(options.gain),
      mirrored(options.mirror != MirroredAxis::none),
      texels_between_trims(between_trims(target, source.base())) {
  require_finite(source);
  // The mean costs more than many a conversion: exact solid angles of every texel.
  if (options.max_error || filter.filter == Filter::area) filter.floor = 1e-3 * mean_radiance(source.base());
  if (interpolates(filter) && copies_texels(target, source.base())) {
    filter.filter = Filter::nearest;
    if (options.max_error) choice = exact_copy(target, filter);
    copied = std::move(source.base());
    return;
  }
  if (options.max_error || reads_levels(filter.filter)) add_levels(source.levels);
  for (Level& level : source.levels) levels.emplace_back(std::move(level));
  if (options.max_error) {
    choice = choose_filter(levels, target, *options.max_error, filter.floor);
    filter = choice->filter;
  }
  sampler = make_sampler(levels, target, filter);
}

// Each texel from where the turn takes its centre.
void Resampler::Prepared::copy(int face, int row, int first, std::span<Colour> out) const {
  if (target.to_source == Rotation(1)) {
    std::ranges::copy(copied->row(face, row).subspan(std::size_t(first), out.size()), out.begin());
    return;
  }
  // Discs are round: half way to their middle, centres move alike, and those beyond the rim lie inside.
  const double pull = on_disc(target.to) ? 0.5 : 1;
  const Point2 size(copied->width(), copied->height());
  std::vector<Point2> places(out.size());
  for (std::size_t k = 0; k < out.size(); ++k)
    places[k] = 0.5 + pull * (Point2(first + int(k) + 0.5, row + 0.5) / size - 0.5);
  std::vector<Direction> d(out.size());
  directions(target.to, face, places, d);
  rotate(target.to_source, d);
  std::vector<Location<double>> at(out.size());
  locate(target.to, d, at);
  for (std::size_t k = 0; k < out.size(); ++k) {
    const Point2 texel = size * (0.5 + (Point2(at[k].u, at[k].v) - 0.5) / pull);
    out[k] = *copied->texel(at[k].face, int(texel.x), int(texel.y));
  }
}

void Resampler::Prepared::fill(int face, int row, std::span<Colour> out) const {
  check_row(faces(target.to), target.size, target.size * aspect(target.to), face, row, out.size());
  const Columns in = columns(target.to, target.size, row);
  std::ranges::fill(out, Colour(0));
  const std::span<Colour> texels = in.of(out);
  for (std::size_t k = 0; k < texels.size(); k += texels_between_trims) {
    const std::span<Colour> part = texels.subspan(k, std::min(texels_between_trims, texels.size() - k));
    copied ? copy(face, row, in.first + int(k), part) : sampler(face, row, in.first + int(k), part);
    for (const PaddedLevel& level : levels) level.trim();
    if (copied) copied->trim();
  }
  if (gain != 1)
    for (Colour& texel : texels) texel = Colour(Rgb<double>(texel) * gain);
}

bool keeps_texels(const EnvironmentMap& source, const ConvertOptions& options) {
  const Target target = make_target(source, options);
  return copies_texels(target, source.base());
}

Resampler::Resampler(EnvironmentMap&& source, const ConvertOptions& options, const Run& run)
    : prepared_(run_operation(run, [&](const Progress&) {
        return std::make_shared<const Prepared>(std::move(source), options);
      })) {}

const Frame& Resampler::frame() const { return prepared_->frame; }
int Resampler::size() const { return prepared_->target.size; }
const FilterOptions& Resampler::filter() const { return prepared_->filter; }
const std::optional<FilterChoice>& Resampler::choice() const { return prepared_->choice; }

Rows Resampler::rows() const {
  const Rows made{frame().projection, size(), frame().forward,
                  [prepared = prepared_](int face, int row, std::span<Colour> out) { prepared->fill(face, row, out); }};
  return prepared_->mirrored ? with_x_negated(made) : made;
}

EnvironmentMap convert(const EnvironmentMap& source, const ConvertOptions& options, const Run& run) {
  return run_operation(run, [&](const Progress& progress) {
    const Resampler resampler(source, options);
    const Rows rows = resampler.rows();
    EnvironmentMap out = blank_map(resampler.frame(), resampler.size());
    Level& level = out.base();
    for_each_row(level.faces(), level.height(), progress,
                 [&](int face, int row) { rows.fill(face, row, level.row(face, row)); });
    if (options.gain > 1) require_no_overflow(level, fmt::format("a gain of {:g}", options.gain), "gain");
    return out;
  });
}

}  // namespace envmap
