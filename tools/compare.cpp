#include <fmt/format.h>

#include <cmath>

#include "command.h"
#include "depfile.h"
#include "envmap/base/error.h"
#include "envmap/operate/convert.h"
#include "envmap/maths/portable.h"
#include "envmap/operate/measure.h"

namespace tools {
namespace {

using namespace envmap;
using nlohmann::ordered_json;

struct Options {
  std::string a, b, difference;
  ReadOptions read;
  std::optional<Projection> from_b;
  std::optional<Filter> filter = Filter::area;
  std::optional<double> max_error, max_rms, max_flux;
  bool one_level = false;  // --level was given, be it 0.
  bool same_shape = false, same_levels = false, same_depth = false, golden = false;
  [[nodiscard]] bool limited() const { return max_error || max_rms || max_flux; }
};

// A limit that was broken, of a level.
struct Breach {
  int level;
  const char* metric;
  double value, limit;
  const char* option;
};

class Limits {
 public:
  explicit Limits(const Options& o) : options_(o) {}
  void check(int level, const Difference& d, bool same_texels) {
    check(level, "flux", d.largest_flux(), options_.max_flux, "--max-flux");
    if (!same_texels) return;
    check(level, "rms", d.rms, options_.max_rms, "--max-rms");
    check(level, "max", d.maximum, options_.max_error, "--max-error");
  }
  [[nodiscard]] const std::vector<Breach>& broken() const { return broken_; }

 private:
  void check(int level, const char* metric, double value, const std::optional<double>& limit, const char* option) {
    if (limit && !(value <= *limit)) broken_.push_back({level, metric, value, *limit, option});
  }
  const Options& options_;
  std::vector<Breach> broken_;
};

std::string shape(const Source& s) {
  const Level& base = s.map.base();
  return fmt::format("{} {}x{}{}", name(base.projection()), base.width(), base.height(),
                     has_forward(base.projection()) ? fmt::format(" forward {}", forward_names[static_cast<int>(s.map.forward)])
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

std::vector<LevelDifference> compare_levels(const EnvironmentMap& a, const EnvironmentMap& b) {
  std::vector<LevelDifference> all;
  for (std::size_t k = 1; k < a.levels.size(); ++k) {
    const bool both = same_frame(a, b) && k < b.levels.size();
    LevelDifference d{both ? compare(a.levels[k], b.levels[k]) : Difference{}, static_cast<int>(k), both};
    if (!both) d.flux = flux_difference(a.levels[k], b.base());
    all.push_back(d);
  }
  return all;
}

// Why the two are not the same kind of file, before any texel is looked at; empty where they are, as far as was asked.
std::string unlike(const Options& o, const Source& a, const Source& b) {
  if (o.same_shape && (!same_frame(a.map, b.map) || a.map.base().width() != b.map.base().width()))
    return fmt::format("{} is {}, {} {} (--same-shape)", o.a, shape(a), o.b, shape(b));
  const std::size_t levels = a.map.levels.size(), wanted = b.map.levels.size();
  if (o.same_levels && levels != wanted)
    return fmt::format("{} has {} level{}, {} {} (--same-levels)", o.a, levels, levels > 1 ? "s" : "", o.b, wanted);
  // Levels of the reference that nothing was held against.
  if (o.limited() && levels < wanted)
    return fmt::format("{} has {} level{}, {} {}: say --level 0 to compare one", o.a, levels, levels > 1 ? "s" : "", o.b,
                       wanted);
  if (o.same_depth && a.depth != b.depth)
    return fmt::format("{} holds {}, {} {} (--same-depth)", o.a, name(a.depth), o.b, name(b.depth));
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
  return {0.5 * (mean_radiance(difference) + std::abs(more)) / all,
          360 / pi * portable::atan2(glm::length(p - q), glm::length(p + q))};
}
std::string words(const Difference& d, const Verdict& v) {
  if (d.maximum == 0) return "identical";
  if (!std::isfinite(v.differs)) return "the reference is black";
  return fmt::format("{:.3g}% of the light differs; the brightest texel moved by {:.3g} degrees", 100 * v.differs, v.moved);
}

ordered_json limits(const Options& o) {
  const auto limit = [](const std::optional<double>& x) { return x ? ordered_json(*x) : ordered_json(nullptr); };
  return {{"max-flux", limit(o.max_flux)},     {"max-rms", limit(o.max_rms)},       {"max-error", limit(o.max_error)},
          {"same-shape", o.same_shape},        {"same-levels", o.same_levels},      {"same-depth", o.same_depth}};
}

int run(Options& o, const Common& common) {
  if (!o.difference.empty()) check_output(o.difference, {}, Projection::cube);
  if (o.difference.empty() && !common.depfile.empty()) throw UsageError("--depfile is for the map of --difference");
  check_files({o.difference}, {o.a, o.b}, common);
  if (o.golden) {
    o.same_shape = o.same_levels = true;
    if (!o.limited()) o.max_error = 0;
  }
  ReadOptions read_a = o.read;
  read_a.all_levels = !o.one_level;
  Source a = read_map(o.a, read_a, common);
  ReadOptions read_b = read_a;
  if (o.from_b) read_b.projection = o.from_b;
  const Source b = read_map(o.b, read_b, common);
  const std::string unlikeness = unlike(o, a, b);
  const std::vector<LevelDifference> levels = compare_levels(a.map, b.map);
  const bool resampled = !same_frame(a.map, b.map);
  a.map.levels.erase(a.map.levels.begin() + 1, a.map.levels.end());  // Or a filter might read them as its own.
  if (resampled)
    a.map = convert(a.map,
                    {.to = b.map.frame(), .size = b.map.base().height(), .filter = o.filter},
                    progress_line(common, "resample"));
  Level shown(b.map.projection(), b.map.base().height());
  const Difference d = compare(a.map.base(), b.map.base(), &shown);
  const Verdict verdict = verdict_of(a.map, b.map, shown);

  Limits limits_of_each(o);
  limits_of_each.check(0, d, true);
  for (const LevelDifference& level : levels) limits_of_each.check(level.number, level, level.same_texels);
  const std::vector<Breach>& broken = limits_of_each.broken();
  const bool same = unlikeness.empty() && broken.empty();
  if (common.json) {
    ordered_json j;
    j["a"] = o.a;
    j["b"] = o.b;
    j["resampled"] = resampled;
    j["flux"] = to_json(d.flux);
    j["rms"] = d.rms;
    j["max"] = d.maximum;
    j["light_differs"] = verdict.differs;
    j["brightest_moved"] = verdict.moved;
    j["worst"] = {{"face", d.worst.face}, {"texel", {d.worst.i, d.worst.j}}};
    for (const LevelDifference& level : levels)
      j["levels"].push_back({{"level", level.number},
                             {"flux", to_json(level.flux)},
                             {"rms", level.same_texels ? ordered_json(level.rms) : ordered_json(nullptr)},
                             {"max", level.same_texels ? ordered_json(level.maximum) : ordered_json(nullptr)}});
    j["limits"] = limits(o);
    j["unlike"] = unlikeness.empty() ? ordered_json(nullptr) : ordered_json(unlikeness);
    j["broken"] = ordered_json::array();
    for (const Breach& breach : broken)
      j["broken"].push_back({{"level", breach.level}, {"metric", breach.metric}, {"value", breach.value}, {"limit", breach.limit}});
    j["within"] = same;
    print_report(j);
  } else {
    print(fmt::format("flux {:+.3e} {:+.3e} {:+.3e}\nrms  {:.3e}\nmax  {:.3e}  at face {}, texel ({},{})\n{}\n", d.flux.x,
                      d.flux.y, d.flux.z, d.rms, d.maximum, d.worst.face, d.worst.i, d.worst.j, words(d, verdict)));
    for (const LevelDifference& level : levels)
      print(fmt::format("level {:2}  flux {:+.3e} {:+.3e} {:+.3e}{}\n", level.number, level.flux.x, level.flux.y,
                        level.flux.z,
                        level.same_texels ? fmt::format("  rms {:.3e}  max {:.3e}", level.rms, level.maximum) : ""));
    if (resampled) warn(fmt::format("{} was resampled to the texels of {}", o.a, o.b));
  }
  if (!o.difference.empty()) {
    EnvironmentMap out;
    out.levels.push_back(std::move(shown));
    out.forward = b.map.forward;
    write_map(o.difference, rows_of(out), {}, {o.a, o.b}, "write", common);
  }
  if (!unlikeness.empty()) warn("envmap compare: " + unlikeness);
  for (const Breach& x : broken)
    warn(fmt::format("envmap compare: {}{} {:.3g} > {:g} ({})", x.level > 0 ? fmt::format("level {}: ", x.level) : "", x.metric,
                     x.value, x.limit, x.option));
  return same ? 0 : 1;
}

void add_limit(CLI::App& app, const std::string& flag, std::optional<double>& limit, const std::string& help) {
  app.add_option(flag, limit, help)->type_name("E")->check(number_in(CLI::NonNegativeNumber));
}

}  // namespace

Command compare_command() {
  return {
      .name = "compare",
      .summary = "Compare two environment maps: flux, rms and largest error, weighted by solid angle",
      .description =
          "B is the reference. flux is the relative difference of the total flux of each channel; rms is the root of "
          "sum w |a-b|^2 / sum w |b|^2 with w the solid angle; max is the largest |a-b| / max(|b|, 0.001 x mean of b) "
          "of any "
          "texel and channel. Where projection, size or forward axis differ, A is resampled to the texels of B.\n\n"
          "Of a map with mip levels each level is shown: against the same of B where B has it, else its flux against "
          "that of "
          "B. Limits hold for all of them; --level compares one.\n\n"
          "Exit status 1 where a limit is given and exceeded, or B has levels that A lacks; each limit that broke is named "
          "on standard error. --golden is for tests against kept results.",
      .examples = {{"envmap compare new.exr golden.exr --golden --max-rms 1e-3", "a golden-file test: exit status 1 if beyond"},
                   {"envmap compare cube.exr probe.hdr --json", "how much a conversion lost; A is resampled to B"},
                   {"envmap compare a.exr b.exr --difference d.exr", "where they differ"}},
      .keys = {{"a", "text", "the map that is judged"},
               {"b", "text", "the reference"},
               {"resampled", "boolean", "whether A was resampled to the texels of B"},
               {"flux", "triple", "relative difference of the total flux of each channel: red, green, blue"},
               {"rms", "number", "root of sum w |a-b|^2 / sum w |b|^2"},
               {"max", "number", "largest |a-b| / max(|b|, 0.001 x mean of b)"},
               {"light_differs", "number", "light gained or lost, whichever is more, over that of b: what moved, or changed its colour, counts once"},
               {"brightest_moved", "number", "degrees between the brightest texels of a and b"},
               {"worst.face", "count", "where max is"},
               {"worst.texel", "texel", "column and row there"},
               {"levels[]", "object?", "of maps with mip levels; else absent"},
               {"levels[].level", "count", "its number, from 1"},
               {"levels[].flux", "triple", "as above"},
               {"levels[].rms", "number", "as above; null where B has no such level"},
               {"levels[].max", "number", "as above; null where B has no such level"},
               {"limits.max-flux", "number", "what --max-flux says; null where nothing is said, as of the next two"},
               {"limits.max-rms", "number", "what --max-rms says"},
               {"limits.max-error", "number", "what --max-error says"},
               {"limits.same-shape", "boolean", "whether it was asked for"},
               {"limits.same-levels", "boolean", "whether it was asked for"},
               {"limits.same-depth", "boolean", "whether it was asked for"},
               {"unlike", "text or null", "why the two are not the same kind of file; null where they are"},
               {"broken[].level", "count", "of each limit that is exceeded"},
               {"broken[].metric", "text", "flux, rms or max"},
               {"broken[].value", "number", "what it is"},
               {"broken[].limit", "number", "what it may be"},
               {"within", "boolean", "true where the exit status is 0"}},
      .reports = true,
      .writes = true,
      .define = [](CLI::App& app, const Common& common) -> std::function<int()> {
        auto o = std::make_shared<Options>();
        app.add_option("A", o->a, "Map to judge")->required();
        app.add_option("B", o->b, "Reference")->required();
        add_limit(app, "--max-error", o->max_error, "Exit with 1 if max is larger");
        add_limit(app, "--max-rms", o->max_rms, "Exit with 1 if rms is larger");
        add_limit(app, "--max-flux", o->max_flux, "Exit with 1 if flux of any channel differs by more");
        app.add_flag("--same-shape", o->same_shape, "Exit with 1 where projection, size or forward axis differ");
        app.add_flag("--same-levels", o->same_levels, "Exit with 1 where one has more levels than the other");
        app.add_flag("--same-depth", o->same_depth, "Exit with 1 where one holds half floats, say, and the other floats");
        app.add_flag("--golden", o->golden, "--same-shape and --same-levels, and --max-error 0 where no limit is given");
        app.add_option("--difference", o->difference, "Write |A-B| as a map")->type_name("FILE");
        add_filter(app, o->filter, "How A is resampled if it must be (default: area)");
        add_read_options(app, o->read);
        add_repair(app, o->read);
        add_projection(app, "--from-b", o->from_b, "Projection of B, if not that of --from");
        return [o, &app, &common] {
          o->one_level = app.count("--level") > 0;
          return run(*o, common);
        };
      }};
}

}  // namespace tools
