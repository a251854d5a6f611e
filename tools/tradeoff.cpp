// What accuracy costs: every way to do a task, timed, beside its error against the reference.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "calibrate.h"
#include "command.h"
#include "costs_file.h"
#include "depfile.h"
#include "envmap/base/error.h"
#include "envmap/io/picture.h"
#include "envmap/operate/measure.h"
#include "tradeoff_bake.h"
#include "tradeoff_plot.h"
#include "tradeoff_scene.h"
#include "tradeoff_tasks.h"
#include "tradeoff_view.h"

namespace tools {
namespace {

using namespace envmap;

enum class Metric { rms, maximum, flux };
constexpr std::string_view metric_names[] = {"rms", "max", "flux"};

struct Options {
  std::string input, task, only, plot, at, camera, environment, costs, saved;
  ReadOptions read;
  bool csv = false, calibrate = false;
  Metric by = Metric::rms;
  double budget = 60;
};

std::string label_of(const std::string& method, const std::string& setting) { return setting.empty() ? method : method + " " + setting; }

struct Trial {
  std::string method, setting;
  double seconds, noise;  // The median of its runs, and how far the others are from it at most, over it.
  int runs;
  Difference error;
  std::optional<std::int64_t> bytes;
  double missing_solid_angle = 0;  // Steradians.
  bool front = false;

  [[nodiscard]] double cost() const { return bytes ? static_cast<double>(*bytes) : seconds; }
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

// Runs until there are five, or this way's part of the time is over. The first of several only warms caches up and compiles shaders: where
// that is little of the rest of the time there is a second.
Trial measured(const Way& way, double seconds, double rest, Outcome& out) {
  constexpr std::size_t enough = 6;
  const Stopwatch whole;
  std::vector<double> times;
  do {
    const Stopwatch watch;
    out = way.run();
    times.push_back(watch.seconds());
  } while (times.size() < enough && (whole.seconds() + times.back() < seconds || (times.size() == 1 && times.back() < 0.05 * rest)));
  if (times.size() > 1) times.erase(times.begin());
  std::ranges::sort(times);
  const double median = times[times.size() / 2], off = std::max(median - times.front(), times.back() - median);
  return {way.method, way.setting, median, off / median, static_cast<int>(times.size()), {}, out.bytes, out.missing_solid_angle};
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

Study study_of(const Task& task, const Options& o, const Common& common) {
  const Progress progress = progress_line(common, "measuring");
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
    Trial trial = measured(way, rest / static_cast<double>(task.ways.size() - k), rest, out);
    rest -= watch.seconds();
    trial.error = way.judge ? as_reference([&] { return way.judge(out); }) : compare(out.level, truth->level);
    study.trials.push_back(trial);
    if (progress) progress(static_cast<double>(k + 1) / static_cast<double>(task.ways.size()));
  }
  mark_front(study.trials, o.by);
  return study;
}

std::string table_of(const Study& study, const Options& o) {
  std::size_t wide = 10;
  for (const Trial& t : study.trials) wide = std::max(wide, t.label().size());
  const bool files = !study.trials.empty() && study.trials[0].bytes;
  std::string out = fmt::format("{} of {}; errors against {} ({:.3g} s)\n", o.task, o.input, study.task.reference, study.reference_seconds);
  out += fmt::format("  {:{}}  {:>10}  {:>5}{}  {:>8}  {:>8}  {:>8}\n", "", wide, "seconds", "+-", files ? "       bytes" : "",
                     "max", "rms", "flux");
  for (const Trial& t : study.trials)
    out += fmt::format("{} {:{}}  {:>10.3g}  {:>4.0f}%{}  {:>8.1e}  {:>8.1e}  {:>8.1e}\n", t.front ? '*' : ' ', t.label(), wide,
                       t.seconds, 100 * t.noise, t.bytes ? fmt::format("{:>12}", *t.bytes) : "", t.error.maximum, t.error.rms,
                       t.error.largest_flux());
  for (const Trial& t : study.trials)
    if (t.missing_solid_angle > 0)
      out += fmt::format("{}: no star: surfaces near the singularity are missing, up to {:.2g} sr\n", t.label(), t.missing_solid_angle);
  out += fmt::format("* nothing else is both {} and closer in {}\n", files ? "smaller" : "faster",
                     metric_names[static_cast<std::size_t>(o.by)]);
  return out;
}

std::string csv_of(const Study& study) {
  std::string out = "method,setting,seconds,noise,runs,bytes,max,rms,flux,front,missing_solid_angle\n";
  for (const Trial& t : study.trials)
    out += fmt::format("{},{},{},{},{},{},{},{},{},{},{}\n", t.method, t.setting, t.seconds, t.noise, t.runs,
                       t.bytes ? std::to_string(*t.bytes) : "", t.error.maximum, t.error.rms, t.error.largest_flux(), t.front ? 1 : 0, t.missing_solid_angle);
  return out;
}

nlohmann::ordered_json report_of(const Study& study, const Options& o) {
  nlohmann::ordered_json report{{"input", o.input}, {"task", o.task}};
  report["reference"] = {{"what", study.task.reference}, {"seconds", study.reference_seconds}};
  report["by"] = metric_names[static_cast<std::size_t>(o.by)];
  report["trials"] = nlohmann::ordered_json::array();
  for (const Trial& t : study.trials) {
    nlohmann::ordered_json one{{"method", t.method}, {"setting", t.setting}, {"seconds", t.seconds}, {"noise", t.noise}, {"runs", t.runs}};
    if (t.bytes) one["bytes"] = *t.bytes;
    one["max"] = t.error.maximum, one["rms"] = t.error.rms, one["flux"] = t.error.largest_flux(), one["front"] = t.front;
    one["missing_solid_angle"] = t.missing_solid_angle;
    report["trials"].push_back(one);
  }
  report["left_out"] = study.left_out;
  return report;
}

bool is_png(const std::string& path) { return path.ends_with(".png") || path.ends_with(".PNG"); }

void write_plot(const Study& study, const Options& o, const Common& common) {
  std::vector<PlotPoint> points;
  for (const Trial& t : study.trials) points.push_back({t.cost(), t.value(o.by), t.method, t.label(), t.front});
  const bool files = !study.trials.empty() && study.trials[0].bytes;
  const Drawing drawing = plot(points, fmt::format("{} of {}", o.task, printable(o.input)), files ? "bytes" : "seconds",
                               fmt::format("{} error", metric_names[static_cast<std::size_t>(o.by)]));
  if (!is_png(o.plot)) return write_text(o.plot, svg_of(drawing), common.commit);
  try {
    const Picture picture = picture_of(drawing, 2);
    write_stored(o.plot, picture.size.width, picture.pixels, Depth::uint8, {.commit = common.commit});
  } catch (const OutputError& e) {
    if (!e.file().empty()) throw;
    throw OutputError(o.plot, e.what());
  }
}

void check(const Options& o, const Common& common) {
  if (o.csv && common.json) throw UsageError("--csv and --json: choose one");
  const bool of_view = parts_of(o.task)[0] == "view";
  if (!is_of_scene(o.task) && !o.environment.empty()) throw UsageError("--environment is for scenes");
  if (!o.at.empty() && (of_view || !is_of_scene(o.task))) throw UsageError("--at is for --task render");
  if (!o.camera.empty() && !of_view) throw UsageError("--camera is for --task view");
  if (o.plot.empty()) return;
  check_report(o.plot, common);
  check_files({o.plot}, {o.input}, common);
  if (o.plot != "-" && !o.plot.ends_with(".svg") && !is_png(o.plot)) throw UsageError(o.plot, "--plot writes .svg and .png");
  if (o.plot == "-" && o.csv) throw UsageError("--csv and --plot both go to standard output");
}

void tell(const Study& study, const Options& o, const Common& common) {
  if (!o.plot.empty()) write_plot(study, o, common);
  if (common.json)
    print_report(report_of(study, o));
  else if (o.csv)
    print(csv_of(study));
  else if (o.plot != "-")
    print(table_of(study, o));
  if (study.left_out > 0)
    warn(fmt::format("envmap tradeoff: {} of {} ways left out after {:g} s; say --budget to allow more", study.left_out,
                     study.task.ways.size(), o.budget));
}

// Leaves the ways whose method and setting hold the words. @throws UsageError where there is none.
Task only(Task task, const std::string& words) {
  std::string all;
  for (const Way& way : task.ways) all += (all.empty() ? "" : ", ") + label_of(way.method, way.setting);
  std::erase_if(task.ways, [&](const Way& way) { return label_of(way.method, way.setting).find(words) == std::string::npos; });
  if (task.ways.empty()) throw UsageError(fmt::format("--only: '{}' is in none of {}", words, all));
  return task;
}

// The figures that automatic choices rest on, measured here, beside the defaults.
int calibrate(const Options& o, const Common& common) {
  if (common.json) throw UsageError("--calibrate: --save FILE writes JSON, and --save - prints it");
  const Costs costs = calibrated(common);
  if (!o.saved.empty()) write_text(o.saved, text_of(costs), common.commit);
  std::string table = fmt::format("{:18}  {:>10}  {:>10}  nanoseconds\n", "", "default", "here");
  for (std::size_t k = 0; k < cost_count; ++k) {
    const CostFact& fact = cost_facts()[k];
    table += fmt::format("{:18}  {:>10.0f}  {:>10.0f}  {}\n", fact.name, fact.nanoseconds, costs.nanoseconds[k], fact.what);
  }
  if (o.saved == "-") return 0;
  print(table);
  if (!o.saved.empty()) note(common, fmt::format("{}: say --costs {}, or ENVMAP_COSTS in the environment", o.saved, o.saved));
  return 0;
}

int run(Options& o, const Common& common) {
  if (o.calibrate != o.input.empty() || o.calibrate == !o.task.empty())
    throw UsageError("name an INPUT and a --task, or say --calibrate alone");
  if (o.calibrate) return calibrate(o, common);
  if (!o.saved.empty()) throw UsageError("--save is for --calibrate");
  check(o, common);
  const Costs costs = read_costs(o.costs, common);
  if (is_of_scene(o.task)) {
    SceneOptions scene{.path = o.input, .environment = o.environment};
    scene.read.max_pixels = o.read.max_pixels;
    const LoadedScene loaded = load(scene, common);
    if (is_dark(loaded, scene))
      throw UsageError(o.input, "no light in it, so every method would be right: give some with --environment MAP");
    const Task all = parts_of(o.task)[0] == "view" ? make_view_task(o.task, loaded, scene, o.camera)
                                                   : make_scene_task(o.task, loaded, scene, o.at);
    const Task task = only(all, o.only);
    tell(study_of(task, o, common), o, common);
  } else {
    const Source source = read_map(o.input, o.read, common);
    const Task task = only(parts_of(o.task)[0] == "bake" ? make_bake_task(o.task, source, costs, common) : make_task(o.task, source.map, costs), o.only);
    tell(study_of(task, o, common), o, common);
  }
  return 0;
}

}  // namespace

Command tradeoff_command() {
  return {
      .name = "tradeoff",
      .summary = "Measure what accuracy costs: every method of a task, timed, beside its error",
      .description =
          "Does a task in every way there is, on this machine and with this map, and prints for each the time of the "
          "operation alone (from texels in memory to texels in memory; reading and writing apart), how far other runs were "
          "from it, and its error against a slow reference: max, rms and flux, as 'envmap compare' has them. A star marks "
          "what no other way beats in both.\n\n"
          "Times are medians of at most five runs after one that warms up; a way that would take more than its part of "
          "--budget is run once. One after the other they have all threads (--threads).\n\n"
          "--calibrate measures the times by which other commands choose a method: filters of 'convert --max-error', lobes of "
          "'prefilter' and 'bake', ways of 'render'. They are read where --costs or ENVMAP_COSTS names their file, and nowhere else: "
          "without, the same command gives the same bytes on every machine.\n\n"
          "Tasks, P a projection and N the height of a face:\n"
          "  convert:P[:N]      all filters; the reference is 'area' to 1e-6\n"
          "  mipmap:K           level K by solid angle and by plain means, as glGenerateMipmap takes them; the reference is the "
          "mean over level 0\n"
          "  diffuse[:P:N], phong:M[:P:N], ggx:R[:P:N], blinn-phong:M[:P:N], charlie:R[:P:N]\n"
          "                     the methods of prefilter at errors of 1e-1 to 1e-4; a cube of 16 if nothing is said; the "
          "reference is the exact sum where that takes seconds, else the tree to 1e-5\n"
          "  depth              file formats, depths and compressions: size of the file, time to write and read it (in "
          "TMPDIR), and what is lost; stars are by size\n"
          "  bake:ENGINE        what 'bake --for ENGINE' writes, in every quality and in every depth that its files hold: time to make "
          "and write all of them, their size, and the worst error of all levels that are read back, each at its own size (what "
          "fewer texels do not show is not counted: see convert); stars are by size\n"
          "  render:P[:N]       INPUT is a scene (glTF, OBJ): the methods of render, lit by --environment, from --at; 256 high if "
          "nothing is said; the reference is raycast\n"
          "  view[:N]           INPUT is a scene with mirrors: pictures of N x N pixels (256) of --camera, by 'view --maps' of each "
          "projection, lookup and size, and by rays; every pixel counts the same; the reference is raycast, whose rays "
          "go through the same points of each pixel",
      .examples = {{"envmap tradeoff probe.hdr --task convert:cube:256", "which filter is worth its time"},
                   {"envmap tradeoff probe.hdr --task ggx:0.4 --plot ggx.png", "time against error, as a picture"},
                   {"envmap tradeoff probe.hdr --task bake:filament", "what qualities and depths cost an engine's files, and what they lose"},
                   {"envmap tradeoff cellar.glb --task view --camera entrance --only cube", "how cubes of mirrors are drawn best"},
                   {"envmap tradeoff cellar.glb --task render:sphere --environment probe.hdr", "how a scene's map is drawn best"},
                   {"envmap tradeoff --calibrate --save costs.json", "for --costs of convert, prefilter, bake and render"},
                   {"envmap tradeoff probe.hdr --task depth --by max --json", "file size against error, for programs"}},
      .keys = {{"input", "text", "INPUT"},
               {"task", "text", "as it was given"},
               {"reference.what", "text", "what errors are counted from"},
               {"reference.seconds", "number", "how long it took"},
               {"by", "text", "the metric that 'front' is judged by"},
               {"trials[].method", "text", "a filter, a method or a file format"},
               {"trials[].setting", "text", "its options"},
               {"trials[].seconds", "number", "median of its runs"},
               {"trials[].noise", "number", "how far other runs were from it at most, relative to it"},
               {"trials[].runs", "count", "how many, the first apart"},
               {"trials[].bytes", "count?", "size of the files; of the tasks depth and bake alone"},
               {"trials[].max", "number", "largest |a-b| / max(|b|, 0.001 x mean of b)"},
               {"trials[].rms", "number", "root of sum w |a-b|^2 / sum w |b|^2"},
               {"trials[].flux", "number", "largest |flux a - flux b| / flux b of a channel"},
               {"trials[].front", "boolean", "whether the map is complete and nothing else is both faster (depth and bake: smaller) and closer"},
               {"trials[].missing_solid_angle", "number", "render: upper bound in steradians of the surfaces that the map lacks"},
               {"left_out", "count", "ways for which --budget left no time"}},
      .reports = true,
      .define = [](CLI::App& app, const Common& common) -> std::function<int()> {
        auto o = std::make_shared<Options>();
        app.add_option("INPUT", o->input, "Map, or scene where the task is render, '-' for standard input; {face} in the name reads six files");
        app.add_option("--task", o->task, "What to measure: " + task_words())->type_name("TASK");
        app.add_flag("--calibrate", o->calibrate, "Measure the times that automatic choices rest on, about a minute, and print them beside the defaults");
        app.add_option("--save", o->saved, "Write what --calibrate measures, for --costs; '-' for standard output")->type_name("FILE");
        add_costs(app, o->costs);
        app.add_option("--only", o->only, "Measure only the ways whose method and options, as the table shows them, hold these words")
            ->type_name("WORDS");
        add_choice(app, "--by", o->by, joined(metric_names), one_of<Metric>(metric_names),
                   "The error that stars and plot are about (default: rms)");
        app.add_option("--budget", o->budget, "Time for all ways together, the reference apart (default: 60)")
            ->type_name("SECONDS")
            ->check(number_in({0.0, 1e6}));
        app.add_option("--camera", o->camera, "Of view: camera of the scene, or a point, as 'view' takes it (default: as of 'view')")
            ->type_name("NAME|X,Y,Z");
        app.add_option("--at", o->at, "Of render: the node or the point X,Y,Z that is drawn from (default: 0,0,0)")->type_name("NODE|X,Y,Z");
        app.add_option("--environment", o->environment, "Of scenes: map that is the background and a light")->type_name("FILE");
        app.add_flag("--csv", o->csv, "Print the table as comma-separated values");
        app.add_option("--plot", o->plot, "Write a picture of cost against error on logarithmic axes: .svg ('-' for standard output) or .png")->type_name("FILE");
        add_read_options(app, o->read);
        add_repair(app, o->read);
        return [o, &common] { return run(*o, common); };
      }};
}

}  // namespace tools
