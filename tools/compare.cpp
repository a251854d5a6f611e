#include <fmt/format.h>

#include <cmath>

#include "command.h"
#include "envmap/operate/convert.h"
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
};

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

// JSON has no infinity.
ordered_json number(double x) { return std::isfinite(x) ? ordered_json(x) : ordered_json("infinite"); }

int run(const Options& o, const Common& common) {
  if (!o.difference.empty()) check_output(o.difference, {}, Projection::cube);
  ReadOptions read_a = o.read;
  read_a.all_levels = o.read.level == 0;
  Source a = read_map(o.a, read_a, common);
  ReadOptions read_b = read_a;
  if (o.from_b) read_b.projection = o.from_b;
  const Source b = read_map(o.b, read_b, common);
  const std::vector<LevelDifference> levels = compare_levels(a.map, b.map);
  const bool resampled = !same_frame(a.map, b.map);
  a.map.levels.erase(a.map.levels.begin() + 1, a.map.levels.end());  // Or a filter might read them as its own.
  if (resampled)
    a.map = convert(a.map,
                    {.to = b.map.frame(), .size = b.map.base().height(), .filter = o.filter},
                    progress_line(common, "resample"));
  Level shown(b.map.projection(), b.map.base().height());
  const Difference d = compare(a.map.base(), b.map.base(), &shown);

  const auto within = [](double value, const std::optional<double>& limit) { return !limit || value <= *limit; };
  bool same = within(d.maximum, o.max_error) && within(d.rms, o.max_rms) && within(d.largest_flux(), o.max_flux);
  for (const LevelDifference& level : levels) {
    same = same && within(level.largest_flux(), o.max_flux);
    if (level.same_texels) same = same && within(level.maximum, o.max_error) && within(level.rms, o.max_rms);
  }
  if (common.json) {
    ordered_json j;
    j["a"] = o.a;
    j["b"] = o.b;
    j["resampled"] = resampled;
    j["flux"] = {number(d.flux.x), number(d.flux.y), number(d.flux.z)};
    j["rms"] = number(d.rms);
    j["max"] = number(d.maximum);
    j["worst"] = {{"face", d.worst.face}, {"texel", {d.worst.i, d.worst.j}}};
    for (const LevelDifference& level : levels)
      j["levels"].push_back({{"level", level.number},
                             {"flux", {number(level.flux.x), number(level.flux.y), number(level.flux.z)}},
                             {"rms", level.same_texels ? number(level.rms) : ordered_json(nullptr)},
                             {"max", level.same_texels ? number(level.maximum) : ordered_json(nullptr)}});
    j["within"] = same;
    print(fmt::format("{}\n", j.dump(2, ' ', false, ordered_json::error_handler_t::replace)));
  } else {
    print(fmt::format("flux {:+.3e} {:+.3e} {:+.3e}\nrms  {:.3e}\nmax  {:.3e}  at face {}, texel ({},{})\n", d.flux.x,
                      d.flux.y, d.flux.z, d.rms, d.maximum, d.worst.face, d.worst.i, d.worst.j));
    for (const LevelDifference& level : levels)
      print(fmt::format("level {:2}  flux {:+.3e} {:+.3e} {:+.3e}{}\n", level.number, level.flux.x, level.flux.y,
                        level.flux.z,
                        level.same_texels ? fmt::format("  rms {:.3e}  max {:.3e}", level.rms, level.maximum) : ""));
    if (resampled) note(common, fmt::format("{} was resampled to the texels of {}", o.a, o.b));
  }
  if (!o.difference.empty()) {
    EnvironmentMap out;
    out.levels.push_back(std::move(shown));
    out.forward = b.map.forward;
    write_map(o.difference, rows_of(out), {}, {o.a, o.b}, "write", common);
  }
  return same ? 0 : 1;
}

void add_limit(CLI::App& app, const std::string& flag, std::optional<double>& limit, const std::string& help) {
  app.add_option(flag, limit, help)->type_name("E")->check(CLI::NonNegativeNumber);
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
          "Exit status 1 where a limit is given and exceeded.",
      .examples = {{"envmap compare new.exr golden.exr --max-rms 1e-3", "a golden-file test: exit status 1 if beyond"},
                   {"envmap compare cube.exr probe.hdr --json", "how much a conversion lost; A is resampled to B"},
                   {"envmap compare a.exr b.exr --difference d.exr", "where they differ"}},
      .reports = true,
      .writes = true,
      .define = [](CLI::App& app, const Common& common) -> std::function<int()> {
        auto o = std::make_shared<Options>();
        app.add_option("A", o->a, "Map to judge")->required();
        app.add_option("B", o->b, "Reference")->required();
        add_limit(app, "--max-error", o->max_error, "Exit with 1 if max is larger");
        add_limit(app, "--max-rms", o->max_rms, "Exit with 1 if rms is larger");
        add_limit(app, "--max-flux", o->max_flux, "Exit with 1 if flux of any channel differs by more");
        app.add_option("--difference", o->difference, "Write |A-B| as a map")->type_name("FILE");
        add_filter(app, o->filter, "How A is resampled if it must be (default: area)");
        add_read_options(app, o->read);
        add_repair(app, o->read);
        add_projection(app, "--from-b", o->from_b, "Projection of B, if not that of --from");
        return [o, &common] { return run(*o, common); };
      }};
}

}  // namespace tools
