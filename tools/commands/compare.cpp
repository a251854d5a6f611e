#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <utility>
#include <vector>

#include "command.h"
#include "envmap/base/error.h"
#include "envmap/io/files/face_names.h"
#include "envmap/map/check_chain.h"
#include "envmap/maths/portable.h"
#include "envmap/operate/convert.h"
#include "envmap/operate/grade.h"
#include "envmap/operate/measure.h"
#include "maps/map_options.h"
#include "maps/read_and_write_maps.h"

namespace tools {
namespace {

using namespace envmap;

struct Request {
  std::string a, b, difference;
  ReadOptions read;
  std::optional<Projection> from_b;
  std::optional<Forward> forward_b;
  std::optional<Filter> filter = Filter::area;
  std::optional<double> max_error, max_rms, max_flux;
  bool one_level = false;  // --level was given, be it 0.
  bool fit_exposure = false;
  bool same_shape = false, same_levels = false, same_depth = false, golden = false;
  [[nodiscard]] bool limited() const { return max_error || max_rms || max_flux; }
};

// A limit of a level, and what it is held against.
struct Breach {
  int level;
  const char* metric;
  double value;
  std::optional<double> limit;
  const char* option;
};

std::string shape(const Source& s) {
  const Level& base = s.map.base();
  return fmt::format("{} {}x{}{}", name(base.projection()), base.width(), base.height(),
                     has_forward(base.projection()) ? fmt::format(" forward {}", forward_names[int(s.map.forward)])
                                                    : "");
}

bool same_frame(const EnvironmentMap& a, const EnvironmentMap& b) {
  return a.projection() == b.projection() && a.base().height() == b.base().height() && a.forward == b.forward;
}

// A level of A beyond the first. Where B has it too, texel by texel; else its flux against that of B.
struct LevelDifference : Difference {
  int number = 0;
  std::optional<Level> shown = {};  // |a-b| by texel.
};

bool same_texels(const Level& a, const Level& b) {
  return a.projection() == b.projection() && a.width() == b.width() && a.height() == b.height();
}

// A level of A in the texels of one of B, or as near as there are: levels of odd latlong maps have no proportions.
Level resample(Level&& level, Forward forward, const Frame& to, int size, const std::optional<Filter>& filter,
               const Progress& progress = {}) {
  EnvironmentMap map{.levels = {}, .forward = forward};
  map.levels.push_back(std::move(level));
  ConvertOptions how{.to = to, .size = size, .filter = filter};
  if (keeps_texels(map, how)) how.filter = Filter::nearest;
  return std::move(convert(map, how, {.progress = progress}).base());
}

// @param a its levels; those beyond the first are in its own frame. @param moved whether that is another than B's.
std::vector<LevelDifference> compare_levels(std::vector<Level>& a, const Frame& frame, bool moved,
                                            const EnvironmentMap& b, const std::optional<Filter>& filter) {
  std::vector<LevelDifference> all;
  for (std::size_t k = 1; k < a.size(); ++k) {
    LevelDifference d{{}, int(k)};
    const Level& other = k < b.levels.size() ? b.levels[k] : b.base();
    if (k < b.levels.size() && (moved || !same_texels(a[k], other)))
      a[k] = resample(std::move(a[k]), frame.forward, b.frame(), other.height(), filter);
    if (k < b.levels.size() && same_texels(a[k], other)) {
      d.shown.emplace(other.projection(), other.height(), other.width());
      static_cast<Difference&>(d) = compare(a[k], other, &*d.shown);
    } else {
      d.flux = flux_difference(a[k], other);
    }
    all.push_back(std::move(d));
  }
  return all;
}

std::vector<Breach> breaches(const Request& o, const Difference& first, const std::vector<LevelDifference>& further) {
  std::vector<Breach> all;
  const auto check = [&](int level, const Difference& d, bool by_texel) {
    const Breach each[] = {{level, "flux", d.largest_flux(), o.max_flux, "--max-flux"},
                           {level, "rms", d.rms, o.max_rms, "--max-rms"},
                           {level, "max", d.maximum, o.max_error, "--max-error"}};
    for (const Breach& b : std::span(each).first(by_texel ? 3 : 1))
      if (b.limit && !(b.value <= *b.limit)) all.push_back(b);
  };
  check(0, first, true);
  for (const LevelDifference& level : further) check(level.number, level, level.shown.has_value());
  return all;
}

// Why the two are not the same kind of file, before any texel is looked at; empty where they are, as far as was asked.
std::string unlike(const Request& o, const Source& a, const Source& b) {
  if (o.same_shape && (!same_frame(a.map, b.map) || a.map.base().width() != b.map.base().width()))
    return fmt::format("{} is {}, {} {} (--same-shape)", o.a, shape(a), o.b, shape(b));
  const std::size_t levels = a.map.levels.size(), wanted = b.map.levels.size();
  if (o.same_levels && levels != wanted)
    return fmt::format("{} has {} level{}, {} has {} (--same-levels)", o.a, levels, levels > 1 ? "s" : "", o.b, wanted);
  // The reference has levels that were not compared.
  if (o.limited() && levels < wanted)
    return fmt::format("{} has {} level{}, {} has {}: use --level 0 to compare one level", o.a, levels,
                       levels > 1 ? "s" : "", o.b, wanted);
  // Further levels of A have nothing to be held against but the flux.
  if ((o.max_rms || o.max_error) && levels > wanted)
    return fmt::format("{} has {} levels, {} has {}: use --level 0 to compare one level, or --max-flux alone", o.a,
                       levels, o.b, wanted);
  if (o.same_depth && a.depth != b.depth)
    return fmt::format("{} has depth {}, {} has {} (--same-depth)", o.a, name(a.depth), o.b, name(b.depth));
  return {};
}

// What people ask first: how much light is elsewhere, or of another colour, and whether the sun stayed where it was.
struct Verdict {
  double differs;  // Light gained or lost, whichever is more, over that of b: what moved counts once.
  double moved;    // Degrees between the brightest directions.
};
Verdict verdict_of(const EnvironmentMap& a, const EnvironmentMap& b, const Level& difference) {
  const Direction p = measure(a).brightest_direction, q = measure(b).brightest_direction;
  const double all = mean_radiance(b.base()), more = mean_radiance(a.base()) - all;
  return {0.5 * (mean_radiance(difference) + std::abs(more)) / all, 180 / pi * angle_between(p, q)};
}
// @param alone whether level 0 is all that there is, or all levels are alike.
std::string words(const Difference& d, const Verdict& v, bool alone) {
  if (d.maximum == 0) return alone ? "identical" : "level 0 is identical";
  if (!std::isfinite(v.differs)) return "the reference is black";
  return fmt::format("light gained or lost: {:.3g}% of the reference; brightest texel moved by {:.3g} degrees",
                     100 * v.differs, v.moved);
}

// @param d of the first level.
void add(Report& report, const Request& o, bool resampled, const Difference& d, const Verdict& verdict,
         const std::vector<LevelDifference>& levels, const std::string& unlikeness, const std::vector<Breach>& broken) {
  report.put("a", o.a);
  report.put("b", o.b);
  report.put("resampled", resampled);
  report.put("flux", Direction(d.flux));
  report.put("rms", d.rms);
  report.put("max", d.maximum);
  report.put("light_differs", verdict.differs);
  report.put("brightest_moved", verdict.moved);
  report.put("worst.face", d.worst.face);
  report.put("worst.texel", ReportValue::Texel{d.worst.i, d.worst.j});
  for (const LevelDifference& level : levels) {
    report.append("levels[]");
    report.put("levels[].level", level.number);
    report.put("levels[].flux", Direction(level.flux));
    report.put("levels[].rms", level.shown ? ReportValue(level.rms) : nullptr);
    report.put("levels[].max", level.shown ? ReportValue(level.maximum) : nullptr);
  }
  report.put("limits.max-flux", o.max_flux);
  report.put("limits.max-rms", o.max_rms);
  report.put("limits.max-error", o.max_error);
  report.put("limits.same-shape", o.same_shape);
  report.put("limits.same-levels", o.same_levels);
  report.put("limits.same-depth", o.same_depth);
  report.put("unlike", unlikeness.empty() ? ReportValue(nullptr) : unlikeness);
  report.put_array("broken");
  for (const Breach& breach : broken) {
    report.append("broken[]");
    report.put("broken[].level", breach.level);
    report.put("broken[].metric", breach.metric);
    report.put("broken[].value", breach.value);
    report.put("broken[].limit", breach.limit);
  }
  report.put("within", unlikeness.empty() && broken.empty());
}

// Multiplies A by the factor that brings its first level nearest to B. @return that factor in stops.
double fit_exposure(std::vector<Level>& a, const Level& b) {
  const double factor = best_exposure(a.front(), b);
  for (Level& level : a) apply(Grade{.gain = Flux(factor)}, level);
  return portable::log2(factor);
}

// One row for each level. @param b how many levels B has.
void print_rows(const Difference& d, const Verdict& verdict, const std::vector<LevelDifference>& levels,
                std::size_t b) {
  const bool alike = levels.size() + 1 == b && std::ranges::all_of(levels, [](const LevelDifference& level) {
                       return level.shown && level.maximum == 0;
                     });
  print(fmt::format("flux {:+.3e} {:+.3e} {:+.3e}\nrms  {:.3e}\nmax  {:.3e}  at face {}, texel ({},{})\n{}\n", d.flux.x,
                    d.flux.y, d.flux.z, d.rms, d.maximum, d.worst.face, d.worst.i, d.worst.j,
                    words(d, verdict, alike)));
  for (const LevelDifference& level : levels)
    print(fmt::format("level {:2}  flux {:+.3e} {:+.3e} {:+.3e}{}\n", level.number, level.flux.x, level.flux.y,
                      level.flux.z,
                      level.shown ? fmt::format("  rms {:.3e}  max {:.3e}", level.rms, level.maximum) : ""));
}

// Levels that only one of the two has, where no limit asked for them.
void tell_levels(const Request& o, std::size_t a, std::size_t b) {
  const std::size_t more = a > b ? a - b : b - a;
  if (more == 0) return;
  warn(fmt::format("envmap compare: {} has {} more level{}, {}", a > b ? o.a : o.b, more, more > 1 ? "s" : "",
                   a > b ? "compared by flux alone" : "not compared"));
}

// Whether a file of that name can hold these levels.
bool holds(const std::string& path, const EnvironmentMap& map) {
  std::vector<LevelSize> faces;
  for (const Level& level : map.levels) faces.push_back({level.width(), level.height()});
  try {
    check_output(path, {}, map.projection(), true);
    check_halving(faces);
  } catch (const UsageError&) {
    return false;
  }
  return true;
}

// |a-b| of the levels that were compared by texel, as many as the file holds.
void write_difference(const Request& o, Level&& base, std::vector<LevelDifference>& levels, Forward forward) {
  EnvironmentMap out{.levels = {}, .forward = forward};
  out.levels.push_back(std::move(base));
  for (LevelDifference& level : levels)
    if (level.shown && level.number == int(out.levels.size())) out.levels.push_back(std::move(*level.shown));
  if (out.levels.size() > 1 && !holds(o.difference, out)) {
    note(fmt::format("envmap compare: {} holds level 0 alone: an .exr file holds all levels", o.difference));
    out.levels.erase(out.levels.begin() + 1, out.levels.end());
  }
  write_map(o.difference, all_rows_of(out), {}, "write");
}

int run(Request& o, Report& report) {
  if (!o.difference.empty()) check_output(o.difference, {}, Projection::cube);
  if (o.golden) {
    o.same_shape = o.same_levels = true;
    if (!o.limited()) o.max_error = 0;
  }
  ReadOptions read_a = o.read;
  read_a.all_levels = !o.one_level;
  ReadOptions read_b = read_a;
  if (o.from_b) read_b.projection = o.from_b;
  // What is said of A is no word against what B itself records.
  read_b.forward = o.forward_b, read_b.assumed_forward = o.read.forward;
  if (has_face(o.a) != has_face(o.b)) (has_face(o.a) ? read_b : read_a).faces.clear();
  Source a = read_map(o.a, read_a);
  const Source b = read_map(o.b, read_b);
  const std::string unlikeness = unlike(o, a, b);
  const std::optional<float>&unit = a.provenance.white_luminance, &others = b.provenance.white_luminance;
  if (unit && others && std::abs(*unit / *others - 1) > 1e-5F)
    note(fmt::format("envmap compare: 1 is {:.6g} cd/m^2 in {} and {:.6g} in {}: the numbers are compared", *unit, o.a,
                     *others, o.b));
  std::vector<Level>& own = a.map.levels;
  const bool moved = !same_frame(a.map, b.map) || !same_texels(own.front(), b.map.base());
  const Frame frame = a.map.frame();
  if (moved)
    own.front() = resample(std::move(own.front()), frame.forward, b.map.frame(), b.map.base().height(), o.filter,
                           progress_line("resample"));
  std::optional<double> stops;
  if (o.fit_exposure) stops = fit_exposure(own, b.map.base());
  std::vector<LevelDifference> levels = compare_levels(own, frame, moved, b.map, o.filter);
  Level shown(b.map.projection(), b.map.base().height(), b.map.base().width());
  const Difference d = compare(own.front(), b.map.base(), &shown);
  a.map.forward = b.map.forward;
  const Verdict verdict = verdict_of(a.map, b.map, shown);

  const std::vector<Breach> broken = breaches(o, d, levels);
  const bool same = unlikeness.empty() && broken.empty();
  if (settings().json) {
    add(report, o, moved, d, verdict, levels, unlikeness, broken);
    if (stops) report.put("exposure", *stops);
  } else {
    print_rows(d, verdict, levels, b.map.levels.size());
    if (stops) print(fmt::format("exposure of A fitted: {:+.4f} stops\n", *stops));
    if (moved) warn(fmt::format("{} was resampled to the texels of {}", o.a, o.b));
  }
  if (!unlikeness.empty())
    warn("envmap compare: " + unlikeness);
  else
    tell_levels(o, own.size(), b.map.levels.size());
  for (const Breach& x : broken)
    warn(fmt::format("envmap compare: {}{} {:.3g} > {:g} ({})", x.level > 0 ? fmt::format("level {}: ", x.level) : "",
                     x.metric, x.value, *x.limit, x.option));
  if (!o.difference.empty()) write_difference(o, std::move(shown), levels, b.map.forward);
  return same ? 0 : 1;
}

void add_limit(Options& o, std::string_view name, std::optional<double>& limit, std::string_view help) {
  o.add(name, "E", &limit, {0, std::numeric_limits<double>::max()}, help);
}

}  // namespace

Action define_compare(Options& o) {
  const auto r = std::make_shared<Request>();
  o.reads("A", r->a, "Map to judge, or '-' for stdin").required = true;
  o.reads("B", r->b, "Reference, or '-' for stdin").required = true;
  o.group = "Limits (exit 1 if one is exceeded)";
  add_limit(o, "--max-rms", r->max_rms, "Limit of rms (0.01: 1%)");
  add_limit(o, "--max-error", r->max_error, "Limit of max, the relative difference of a texel (0.01: 1%)");
  add_limit(o, "--max-flux", r->max_flux, "Limit of flux, of each channel (0.01: 1%)");
  o.flag("--golden", r->golden, "As --same-shape --same-levels; if no limit is given, also as --max-error 0");
  o.flag("--same-shape", r->same_shape, "Require equal projection, size and forward axis");
  o.flag("--same-levels", r->same_levels, "Require equal numbers of mip levels");
  o.flag("--same-depth", r->same_depth, "Require equal depths, such as half");
  o.group = "Comparison";
  o.add("--difference", "FILE", &r->difference,
        "Write |A-B| as a map with the texels of B, with all levels if the format has levels")
      .file = File::output;
  o.flag("--fit-exposure", r->fit_exposure, "First multiply A by the factor that brings it nearest to B");
  add_filter(o, r->filter, "Filter that resamples A to the texels of B (default: area)");
  add_read_options(o, r->read);
  add_repair(o, r->read);
  o.group = groups::input_map;
  add_projection(o, "--from-b PROJECTION", r->from_b, "Projection of B (default: as for A)");
  add_forward(o, "--from-forward-b AXIS", r->forward_b, "Axis at the centre of B (default: metadata, as for A)");
  return [r, &o](Report& report) {
    r->one_level = o.given("--level");
    return run(*r, report);
  };
}

}  // namespace tools
