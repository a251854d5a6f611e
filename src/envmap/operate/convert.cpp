#include "envmap/operate/convert.h"

#include <algorithm>
#include <limits>

#include "envmap/map/gutter.h"
#include "envmap/operate/levels.h"
#include "envmap/operate/measure.h"
#include "envmap/base/parallel.h"

namespace envmap {
namespace {

// Degrees that a texel spans along the height of a face.
double pitch(Projection p, int size) {
  return visit(p, [](auto q) { return decltype(q)::span; }) / size;
}

// Whether the result's texels are the source's own.
bool same_texels(const Conversion& c, const EnvironmentMap& source) {
  return c.to == source.projection() && c.size == source.base().height() &&
         target_of(c, source).to_source == Rotation(1);
}

// Whether a filter then gives their values back.
bool interpolates(const Conversion& c) {
  return c.samples == 1 && (c.filter == Filter::nearest || c.filter == Filter::bilinear || c.filter == Filter::bicubic);
}

// Texels of the result between looks at the memory of a source in a scratch file: each place may bring in 16 pages, a
// large area more than that.
std::size_t between_trims(const Level& from, const Conversion& c) {
  if (from.max_memory() == 0) return std::numeric_limits<std::size_t>::max();
  const double covers = pitch(c.to, c.size) / pitch(from.projection(), from.height());
  return static_cast<std::size_t>(std::clamp(256 * 64 / (covers * covers), 1.0, 256.0));
}

}  // namespace

Conversion resolved(const Conversion& wanted, const EnvironmentMap& source) {
  Conversion c = wanted;
  if (c.size == 0) c.size = matching_size(source.projection(), source.base().height(), c.to);
  if (c.area_tolerance == 0) c.area_tolerance = c.filter == Filter::automatic ? 1e-3 : 1e-4;
  if (!has_forward(c.to)) c.forward = Forward::plus_z;
  if (c.filter == Filter::automatic) {
    const double covers = pitch(c.to, c.size) / pitch(source.projection(), source.base().height());
    c.filter = covers > 1.25 ? Filter::area : Filter::bilinear;
    if (covers > 0.5 && !same_texels(c, source)) c.samples = std::max(c.samples, 2);
  }
  return c;
}

Target target_of(const Conversion& c, const EnvironmentMap& source) {
  return {c.to, c.size,
          glm::transpose(image_to_world(source.forward)) * glm::transpose(c.rotation) * image_to_world(c.forward)};
}

Rows converted(EnvironmentMap& source, const Conversion& wanted) {
  const Conversion c = resolved(wanted, source);
  const Target target = target_of(c, source);
  if (reads_levels(c.filter)) add_levels(source.levels);
  const Level& from = source.base();
  // The same texels: nothing to resample, and nothing to lose at a rim.
  if (interpolates(c) && same_texels(c, source))
    return {c.to, c.size, c.forward, [&from, c](int face, int row, std::span<Colour> out) {
              const Columns in = columns(c.to, c.size, row);
              std::ranges::fill(out, Colour(0));
              from.trim();
              for (int i = in.first; i < in.end; ++i)
                out[static_cast<std::size_t>(i)] = Colour(Direction(*from.texel(face, i, row)) * c.gain);
            }};
  for (Level& level : source.levels) fill_gutter(level);
  // The mean costs more than many a conversion: exact solid angles of every texel.
  const double floor = c.filter == Filter::area ? 1e-3 * mean_radiance(source.base()) : 0;
  const Sampler sample = make_sampler(source.levels, target, {c.filter, c.samples, c.area_tolerance, floor});
  const std::size_t at_once = between_trims(from, c);
  return {c.to, c.size, c.forward, [c, sample, at_once, &source](int face, int row, std::span<Colour> out) {
            const Columns in = columns(c.to, c.size, row);
            std::ranges::fill(out, Colour(0));
            const auto texels =
                out.subspan(static_cast<std::size_t>(in.first), static_cast<std::size_t>(in.end - in.first));
            for (std::size_t k = 0; k < texels.size(); k += at_once) {
              sample(face, row, in.first + static_cast<int>(k), texels.subspan(k, std::min(at_once, texels.size() - k)));
              for (const Level& level : source.levels) level.trim();
            }
            if (c.gain != 1)
              for (Colour& texel : texels) texel = Colour(Direction(texel) * c.gain);
          }};
}

EnvironmentMap convert(EnvironmentMap& source, const Conversion& wanted, const Progress& progress) {
  const Rows rows = converted(source, wanted);
  EnvironmentMap out;
  out.levels.emplace_back(rows.projection, rows.size);
  out.forward = rows.forward;
  Level& level = out.base();
  for_each_row(level.faces(), level.height(), progress,
               [&](int face, int row) { rows.fill(face, row, level.row(face, row)); });
  return out;
}

}  // namespace envmap
