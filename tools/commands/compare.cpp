#include <fmt/format.h>

#include <cmath>
#include <iterator>
#include <limits>
#include <span>

#include "command.h"
#include "envmap/base/error.h"
#include "envmap/io/path.h"
#include "envmap/maths/portable.h"
#include "envmap/operate/convert.h"
#include "envmap/operate/grade.h"
#include "envmap/operate/measure.h"
#include "shared/map_options.h"
#include "shared/maps.h"

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
  int number;
  bool same_texels;
};

// @param further those of A. @param same_texels whether A has the frame of B.
std::vector<LevelDifference> compare_levels(const std::vector<Level>& further, const EnvironmentMap& b,
                                            bool same_texels) {
  std::vector<LevelDifference> all;
  for (const Level& level : further) {
    const std::size_t k = all.size() + 1;
    const bool both = same_texels && k < b.levels.size();
    LevelDifference d{both ? compare(level, b.levels[k]) : Difference{}, int(k), both};
    if (!both) d.flux = flux_difference(level, b.base());
    all.push_back(d);
  }
  return all;
}

std::vector<Breach> breaches(const Request& o, const Difference& first, const std::vector<LevelDifference>& further) {
  std::vector<Breach> all;
  const auto check = [&](int level, const Difference& d, bool same_texels) {
    const Breach each[] = {{level, "flux", d.largest_flux(), o.max_flux, "--max-flux"},
                           {level, "rms", d.rms, o.max_rms, "--max-rms"},
                           {level, "max", d.maximum, o.max_error, "--max-error"}};
    for (const Breach& b : std::span(each).first(same_texels ? 3 : 1))
      if (b.limit && !(b.value <= *b.limit)) all.push_back(b);
  };
  check(0, first, true);
  for (const LevelDifference& level : further) check(level.number, level, level.same_texels);
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
std::string words(const Difference& d, const Verdict& v) {
  if (d.maximum == 0) return "identical";
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
    report.put("levels[].rms", level.same_texels ? ReportValue(level.rms) : nullptr);
    report.put("levels[].max", level.same_texels ? ReportValue(level.maximum) : nullptr);
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
double fit_exposure(Level& base, std::vector<Level>& further, const Level& b) {
  const double factor = best_exposure(base, b);
  const Grade brighter{.gain = Flux(factor)};
  apply(brighter, base);
  for (Level& level : further) apply(brighter, level);
  return portable::log2(factor);
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
  if (o.forward_b) read_b.forward = o.forward_b;
  if (has_face(o.a) != has_face(o.b)) (has_face(o.a) ? read_b : read_a).faces.clear();
  Source a = read_map(o.a, read_a);
  const Source b = read_map(o.b, read_b);
  const std::string unlikeness = unlike(o, a, b);
  const std::optional<float>&unit = a.provenance.white_luminance, &others = b.provenance.white_luminance;
  if (unit && others && std::abs(*unit / *others - 1) > 1e-5F)
    note(fmt::format("envmap compare: 1 is {:.6g} cd/m^2 in {} and {:.6g} in {}: the numbers are compared", *unit, o.a,
                     *others, o.b));
  const bool resampled = !same_frame(a.map, b.map);
  // Apart from the first, or a filter might read them as its own.
  std::vector<Level> further(std::move_iterator(a.map.levels.begin() + 1), std::move_iterator(a.map.levels.end()));
  a.map.levels.erase(a.map.levels.begin() + 1, a.map.levels.end());
  if (resampled) {
    ConvertOptions how{.to = b.map.frame(), .size = b.map.base().height(), .filter = o.filter};
    if (keeps_texels(a.map, how)) how.filter = Filter::nearest;
    a.map = convert(a.map, how, {.progress = progress_line("resample")});
  }
  std::optional<double> stops;
  if (o.fit_exposure) stops = fit_exposure(a.map.base(), further, b.map.base());
  const std::vector<LevelDifference> levels = compare_levels(further, b.map, !resampled);
  Level shown(b.map.projection(), b.map.base().height());
  const Difference d = compare(a.map.base(), b.map.base(), &shown);
  const Verdict verdict = verdict_of(a.map, b.map, shown);

  const std::vector<Breach> broken = breaches(o, d, levels);
  const bool same = unlikeness.empty() && broken.empty();
  if (settings().json) {
    add(report, o, resampled, d, verdict, levels, unlikeness, broken);
    if (stops) report.put("exposure", *stops);
  } else {
    print(fmt::format("flux {:+.3e} {:+.3e} {:+.3e}\nrms  {:.3e}\nmax  {:.3e}  at face {}, texel ({},{})\n{}\n",
                      d.flux.x, d.flux.y, d.flux.z, d.rms, d.maximum, d.worst.face, d.worst.i, d.worst.j,
                      words(d, verdict)));
    for (const LevelDifference& level : levels)
      print(fmt::format("level {:2}  flux {:+.3e} {:+.3e} {:+.3e}{}\n", level.number, level.flux.x, level.flux.y,
                        level.flux.z,
                        level.same_texels ? fmt::format("  rms {:.3e}  max {:.3e}", level.rms, level.maximum) : ""));
    if (stops) print(fmt::format("exposure of A fitted: {:+.4f} stops\n", *stops));
    if (resampled) warn(fmt::format("{} was resampled to the texels of {}", o.a, o.b));
  }
  if (!unlikeness.empty()) warn("envmap compare: " + unlikeness);
  if (const int left_out = int(b.map.levels.size()) - int(further.size()) - 1; unlikeness.empty() && left_out > 0)
    warn(fmt::format("envmap compare: {} has {} more level{}, not compared", o.b, left_out, left_out > 1 ? "s" : ""));
  for (const Breach& x : broken)
    warn(fmt::format("envmap compare: {}{} {:.3g} > {:g} ({})", x.level > 0 ? fmt::format("level {}: ", x.level) : "",
                     x.metric, x.value, *x.limit, x.option));
  if (!o.difference.empty()) {
    EnvironmentMap out;
    out.levels.push_back(std::move(shown));
    out.forward = b.map.forward;
    write_map(o.difference, rows_of(out), {}, "write");
  }
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
  o.add("--difference", "FILE", &r->difference, "Write |A-B| as a map with the texels of B, whatever the limits say")
      .file = File::output;
  o.flag("--fit-exposure", r->fit_exposure, "First multiply A by the factor that brings it nearest to B");
  add_filter(o, r->filter, "Filter that resamples A to the texels of B (default: area)");
  add_read_options(o, r->read);
  add_repair(o, r->read);
  o.group = groups::input_map;
  add_projection(o, "--from-b PROJECTION", r->from_b, "Projection of B (default: as for A)");
  add_forward(o, "--from-forward-b AXIS", r->forward_b, "Axis at the centre of B (default: as for A)");
  return [r, &o](Report& report) {
    r->one_level = o.given("--level");
    return run(*r, report);
  };
}

}  // namespace tools
