// What accuracy costs: every way to do a task, timed, beside its error against the reference.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "command.h"
#include "commands/tradeoff/scene_task.h"
#include "commands/tradeoff/tasks.h"
#include "drawing/plot.h"
#include "envmap/base/error.h"
#include "envmap/io/images/picture.h"
#include "envmap/operate/measure.h"
#include "maps/map_options.h"
#include "maps/read_and_write_maps.h"

namespace tools {
namespace {

using namespace envmap;

enum class Metric { rms, maximum, flux };
constexpr std::string_view metric_names[] = {"rms", "max", "flux"};

struct Request {
  std::string input, task, only, plot, at, camera, environment;
  ReadOptions read;
  bool csv = false;
  Metric by = Metric::rms;
  double budget = 60;
};

std::string label_of(const std::string& method, const std::string& setting) {
  return setting.empty() ? method : method + " " + setting;
}

struct Trial {
  std::string method, setting;
  double seconds, noise;  // The median of its runs, and how far the others are from it at most, over it.
  int runs;
  Difference error;
  std::optional<std::int64_t> bytes;
  double missing_solid_angle = 0;  // Steradians.
  std::vector<StepCount> steps = {};
  bool front = false;

  [[nodiscard]] double cost() const { return bytes ? double(*bytes) : seconds; }
  [[nodiscard]] double value(Metric m) const {
    return m == Metric::rms ? error.rms : m == Metric::maximum ? error.maximum : error.largest_flux();
  }
  [[nodiscard]] std::string label() const { return label_of(method, setting); }
};

struct Study {
  const Task& task;
  double reference_seconds = 0;
  std::vector<Trial> trials;
  std::size_t left_out = 0;  // Ways for which there was no time.
};

// Runs until there are five, or this way's part of the time is over. The first of several only warms caches up and
// compiles shaders: where that is little of the rest of the time there is a second.
Trial measured(const Way& way, double seconds, double rest, Outcome& out) {
  constexpr std::size_t enough = 6;
  const Stopwatch whole;
  std::vector<double> times;
  do {
    const Stopwatch watch;
    out = way.run();
    times.push_back(watch.seconds());
  } while (times.size() < enough &&
           (whole.seconds() + times.back() < seconds || (times.size() == 1 && times.back() < 0.05 * rest)));
  if (times.size() > 1) times.erase(times.begin());
  std::ranges::sort(times);
  const double median = times[times.size() / 2], off = std::max(median - times.front(), times.back() - median);
  return {way.method, way.setting, median, off / median, int(times.size()), {}, out.bytes, out.missing_solid_angle,
          out.steps};
}

// By cost, and at the same cost by error: then what is closer than all before it is beaten by none. NaN never is. A map
// that lacks surfaces is no answer to the task, however close the rest of it is.
void mark_front(std::vector<Trial>& trials, Metric by) {
  std::ranges::stable_sort(trials, {}, [by](const Trial& t) { return std::pair(t.cost(), t.value(by)); });
  double least = std::numeric_limits<double>::infinity();
  for (Trial& t : trials) {
    t.front = t.value(by) < least && t.missing_solid_angle == 0;
    least = t.front ? t.value(by) : least;
  }
}

Study study_of(const Task& task, const Request& o) {
  const Progress progress = progress_line("measuring");
  Study study{task};
  const auto as_reference = [&study](const auto& work) {
    const Stopwatch watch;
    auto result = work();
    study.reference_seconds += watch.seconds();
    return result;
  };
  std::optional<Outcome> truth;
  if (task.truth) truth = as_reference(task.truth);
  double rest = o.budget;
  for (std::size_t k = 0; k < task.ways.size(); ++k) {
    if (rest <= 0 && k > 0) {
      study.left_out = task.ways.size() - k;
      break;
    }
    const Way& way = task.ways[k];
    const Stopwatch watch;
    Outcome out{Level(Projection::latlong, 1)};
    Trial trial = measured(way, rest / double(task.ways.size() - k), rest, out);
    rest -= watch.seconds();
    trial.error = way.judge ? as_reference([&] { return way.judge(out); }) : compare(out.level, truth->level);
    study.trials.push_back(trial);
    if (progress) progress(double(k + 1) / double(task.ways.size()));
  }
  mark_front(study.trials, o.by);
  return study;
}

std::string table_of(const Study& study, const Request& o) {
  std::size_t wide = 10;
  for (const Trial& t : study.trials) wide = std::max(wide, t.label().size());
  const bool files = !study.trials.empty() && study.trials[0].bytes;
  std::string out = fmt::format("{} of {}; errors against {} ({:.3g} s)\n", o.task, o.input, study.task.reference,
                                study.reference_seconds);
  out += fmt::format("  {:{}}  {:>10}  {:>5}{}  {:>8}  {:>8}  {:>8}\n", "", wide, "seconds", "+-",
                     files ? "       bytes" : "", "max", "rms", "flux");
  for (const Trial& t : study.trials)
    out += fmt::format("{} {:{}}  {:>10.3g}  {:>4.0f}%{}  {:>8.1e}  {:>8.1e}  {:>8.1e}\n", t.front ? '*' : ' ',
                       t.label(), wide, t.seconds, 100 * t.noise, t.bytes ? fmt::format("{:>12}", *t.bytes) : "",
                       t.error.maximum, t.error.rms, t.error.largest_flux());
  for (const Trial& t : study.trials)
    if (t.missing_solid_angle > 0)
      out += fmt::format("{}: no star: surfaces near the singularity are missing, up to {:.2g} sr\n", t.label(),
                         t.missing_solid_angle);
  out += fmt::format("* nothing else is both {} and closer in {}\n", files ? "smaller" : "faster",
                     metric_names[std::size_t(o.by)]);
  return out;
}

std::string csv_of(const Study& study) {
  std::string out = "method,setting,seconds,noise,runs,bytes,max,rms,flux,front,missing_solid_angle\n";
  for (const Trial& t : study.trials)
    out += fmt::format("{},{},{},{},{},{},{},{},{},{},{}\n", t.method, t.setting, t.seconds, t.noise, t.runs,
                       t.bytes ? std::to_string(*t.bytes) : "", t.error.maximum, t.error.rms, t.error.largest_flux(),
                       t.front ? 1 : 0, t.missing_solid_angle);
  return out;
}

void add(Report& report, const Study& study, const Request& o) {
  report.put("input", o.input);
  report.put("task", o.task);
  report.put("reference.what", study.task.reference);
  report.put("reference.seconds", study.reference_seconds);
  report.put("by", metric_names[std::size_t(o.by)]);
  report.put_array("trials");
  for (const Trial& t : study.trials) {
    report.append("trials[]");
    report.put("trials[].method", t.method);
    report.put("trials[].setting", t.setting);
    report.put("trials[].seconds", t.seconds);
    report.put("trials[].noise", t.noise);
    report.put("trials[].runs", t.runs);
    if (t.bytes) report.put("trials[].bytes", *t.bytes);
    report.put("trials[].max", t.error.maximum);
    report.put("trials[].rms", t.error.rms);
    report.put("trials[].flux", t.error.largest_flux());
    report.put("trials[].front", t.front);
    report.put("trials[].missing_solid_angle", t.missing_solid_angle);
    report.put_array("trials[].steps");
    for (const StepCount& s : t.steps) {
      report.append("trials[].steps[]");
      report.put("trials[].steps[].step", s.step);
      report.put("trials[].steps[].count", s.count);
    }
  }
  report.put("left_out", study.left_out);
}

bool is_png(const std::string& path) { return path.ends_with(".png") || path.ends_with(".PNG"); }

void write_plot(const Study& study, const Request& o) {
  std::vector<PlotPoint> points;
  for (const Trial& t : study.trials) points.push_back({t.cost(), t.value(o.by), t.method, t.label(), t.front});
  const bool files = !study.trials.empty() && study.trials[0].bytes;
  const Drawing drawing = plot(points, fmt::format("{} of {}", o.task, printable(o.input)), files ? "bytes" : "seconds",
                               fmt::format("{} error", metric_names[std::size_t(o.by)]));
  if (!is_png(o.plot)) return write_text(o.plot, svg_of(drawing));
  try {
    const Picture picture = picture_of(drawing, 2);
    write_stored(o.plot, picture.size.width, picture.pixels, Depth::uint8, {.commit = settings().commit});
  } catch (const OutputError& e) {
    if (!e.file().empty()) throw;
    throw OutputError(o.plot, e.what());
  }
}

// The environment of a scene is read with the options that 'render' has for it.
void refuse_map_options(const Request& o, const Options& options) {
  for (const Option& option : options.rows) {
    const bool is_of_maps =
        option.group == groups::input_map || option.name == "--input-space" || option.name == "--ocio";
    if (is_of_maps && option.name != "--max-pixels" && option.name != "--repair" &&
        options.on_command_line(option.name))
      throw UsageError(o.input, fmt::format("is a scene: remove {}", option.name));
  }
}

void check(const Request& o, const Options& options) {
  if (is_of_scene(o.task)) refuse_map_options(o, options);
  if (o.csv && settings().json) throw UsageError("--csv and --json: choose one");
  const bool of_view = parts_of(o.task)[0] == "view";
  if (!is_of_scene(o.task) && !o.environment.empty()) throw UsageError("--environment is for scenes");
  if (!o.at.empty() && (of_view || !is_of_scene(o.task))) throw UsageError("--at is for --task render");
  if (!o.camera.empty() && !of_view) throw UsageError("--camera is for --task view");
  if (o.plot.empty()) return;
  if (o.plot != "-" && !o.plot.ends_with(".svg") && !is_png(o.plot))
    throw UsageError(o.plot, "--plot writes .svg and .png");
  if (o.plot == "-" && o.csv) throw UsageError("--csv and --plot both go to standard output");
}

void tell(const Study& study, const Request& o, Report& report) {
  if (!o.plot.empty()) write_plot(study, o);
  if (settings().json)
    add(report, study, o);
  else if (o.csv)
    print(csv_of(study));
  else if (o.plot != "-")
    print(table_of(study, o));
  if (study.left_out > 0)
    warn(fmt::format("envmap tradeoff: {} of {} methods skipped after {:g} s: raise --budget", study.left_out,
                     study.task.ways.size(), o.budget));
}

// Leaves the ways whose method and setting hold the words. @throws UsageError where there is none.
Task only(Task task, const std::string& words) {
  std::string all;
  for (const Way& way : task.ways) all += (all.empty() ? "" : ", ") + label_of(way.method, way.setting);
  std::erase_if(task.ways,
                [&](const Way& way) { return label_of(way.method, way.setting).find(words) == std::string::npos; });
  if (task.ways.empty()) throw UsageError(fmt::format("--only: '{}' is in none of {}", words, all));
  return task;
}

int run(Request& o, const Options& options, Report& report) {
  if (o.input.empty() || o.task.empty()) throw UsageError("needs INPUT and --task");
  check(o, options);
  if (is_of_scene(o.task)) {
    SceneOptions scene{.path = o.input, .environment = o.environment};
    scene.read.max_pixels = o.read.max_pixels, scene.read.flaws = o.read.flaws;
    const LoadedScene loaded = load(scene);
    if (loaded.is_dark({}))
      throw UsageError(o.input, "no light in it, so every method would be right: give some with --environment MAP");
    const Task all = parts_of(o.task)[0] == "view" ? make_view_task(o.task, loaded, scene, o.camera)
                                                   : make_scene_task(o.task, loaded, scene, o.at);
    const Task task = only(all, o.only);
    tell(study_of(task, o), o, report);
  } else {
    const Source source = read_map(o.input, o.read);
    const Task task =
        only(parts_of(o.task)[0] == "bake" ? make_bake_task(o.task, source) : make_task(o.task, source.map), o.only);
    tell(study_of(task, o), o, report);
  }
  return 0;
}

}  // namespace

Action define_tradeoff(Options& o) {
  const auto r = std::make_shared<Request>();
  o.reads("INPUT", r->input, "Map, or scene for the tasks render and view, or '-' for stdin");
  o.group = "Measurement";
  o.add("--task", "TASK", &r->task, "What to measure: " + task_words());
  o.add("--by", one_of(r->by, metric_names), "Error metric of the stars and the plot: {} (default: rms)");
  o.add("--only", "TEXT", &r->only, "Measure only rows of the table that contain TEXT, such as bilinear");
  o.add("--budget", "SECONDS", &r->budget, {0, 1e6}, "Time limit of all rows, without the reference (default: 60)");
  o.group = "Output";
  o.add("--plot", "FILE", &r->plot, "Plot time or size against error, as .svg ('-' for stdout) or .png").file =
      File::output;
  o.flag("--csv", r->csv, "Print the table as comma-separated values");
  o.group = "Scenes (tasks render and view)";
  o.add("--environment", "FILE", &r->environment, "Environment map for background and lighting");
  o.add("--at", "NODE|X,Y,Z", &r->at, "render: centre of the map, a node or a point (default: 0,0,0)");
  o.add("--camera", "NAME|X,Y,Z", &r->camera, "view: camera of the scene, or a point (default: as 'envmap view')");
  add_read_options(o, r->read);
  add_repair(o, r->read);
  return [r, &o](Report& report) { return run(*r, o, report); };
}

}  // namespace tools
