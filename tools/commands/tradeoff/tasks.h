// What `tradeoff` measures: the ways to do a task, and the reference that they are judged by.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "envmap/io/files/scratch_file.h"
#include "envmap/io/read.h"
#include "envmap/map/environment_map.h"
#include "envmap/operate/measure.h"
#include "envmap/prefilter/prefilter.h"

namespace tools {

// What came out of a way: its texels, or files; and their size where the task is to write some.
struct Outcome {
  envmap::Level level;
  std::optional<std::int64_t> bytes = {};
  std::vector<std::shared_ptr<const envmap::ScratchFile>> files = {};
  double missing_solid_angle = 0;  // Drawn::missing_solid_angle.
  std::vector<envmap::StepCount> steps = {};  // Of a prefilter.
};

// A method with its parameters, from a map in memory to a result.
struct Way {
  std::string method, setting;
  std::function<Outcome()> run;
  // How far off it is, where that is not a comparison with the task's truth.
  std::function<envmap::Difference(const Outcome&)> judge = {};
};

struct Task {
  std::string name;                     // As the user gave it.
  std::string reference;                // What errors are counted from, in words.
  std::function<Outcome()> truth = {};  // Absent where every way has a judge.
  std::vector<Way> ways = {};
};

// What stands between the colons of a task's name.
std::vector<std::string> parts_of(const std::string& task);
// @throws UsageError where it is none, or beyond 1 to 32768.
envmap::Projection projection_of(const std::string& task, const std::string& text);
int size_of(const std::string& task, const std::string& text);

// The tasks, for --help: `convert:P[:N]` and so on.
std::string task_words();

// @param map must outlive the task. @throws UsageError where the name is none of them, or a number is out of its range.
Task make_task(const std::string& name, const envmap::EnvironmentMap& map);

// The maps of an engine in every quality and in every depth that its files hold, for a task bake:ENGINE.
// @param source must outlive the task.
// @throws UsageError where there is no such engine.
Task make_bake_task(const std::string& name, const envmap::Source& source);

}  // namespace tools
