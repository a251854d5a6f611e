#include "commands/batch/schedule.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <numeric>
#include <set>
#include <vector>

#include "cli/command_line.h"
#include "envmap/base/error.h"
#include "envmap/base/words.h"

namespace tools {
namespace {

using envmap::joined;

// With `before` before each of the characters.
std::string escaped(const std::string& text, std::string_view special, char before) {
  std::string out;
  for (const char c : text) {
    if (c == '\n') throw envmap::UsageError(text, "a name of two lines cannot be scheduled");
    if (special.find(c) != special.npos) out += before;
    out += c;
  }
  return out;
}

// The characters of a name that an engine's file has no way to write, or that mean another thing there.
void refuse(const std::string& path, std::string_view characters, const std::string& engine) {
  if (const std::size_t at = path.find_first_of(characters); at != path.npos)
    throw envmap::UsageError(path,
                             fmt::format("a name with {} cannot stand in a file for {}: rename it", path[at], engine));
}
std::string for_ninja(const std::string& path) {
  refuse(path, "|", "Ninja");
  return escaped(path, "$ :", '$');
}
// A $ is doubled, the rest gets a backslash.
std::string for_make(const std::string& path) {
  refuse(path, ";=%|()*?[\\", "Make");
  return escaped(escaped(path, " #:", '\\'), "$", '$');
}

std::string command(const Job& job, const std::string& program, const std::vector<std::string>& more) {
  std::vector<std::string> words{program};
  words.insert(words.end(), job.words.begin(), job.words.end());
  words.insert(words.begin() + 2, more.begin(), more.end());  // Behind a -- they would be operands.
  return joined(words, " ", quoted);
}

// Which job writes a file.
std::map<std::string, std::size_t> writers(std::span<const Job> jobs) {
  std::map<std::string, std::size_t> all;
  for (std::size_t k = 0; k < jobs.size(); ++k)
    for (const std::string& file : jobs[k].outputs) all[file] = k;
  return all;
}

// What must be there before a job begins: inputs that exist or that others write. Words of options may be such files,
// too. What is missing the job itself says best.
std::vector<std::string> needed(const Job& job, const std::map<std::string, std::size_t>& writer) {
  std::vector<std::string> files;
  for (const std::string& file : job.inputs)
    if (std::error_code error; std::filesystem::exists(file, error) || writer.contains(file)) files.push_back(file);
  for (const std::string& word : job.words)
    if (const std::string file = plain_path(word); writer.contains(file) &&
                                                   std::ranges::find(files, file) == files.end() &&
                                                   std::ranges::find(job.outputs, file) == job.outputs.end())
      files.push_back(file);
  return files;
}

using Jobs = std::vector<std::size_t>;

// The jobs that each waits for.
std::vector<Jobs> awaited(std::span<const Job> jobs) {
  const auto writer = writers(jobs);
  std::vector<Jobs> all;
  for (const Job& job : jobs) {
    Jobs& these = all.emplace_back();
    for (const std::string& file : needed(job, writer))
      if (const auto w = writer.find(file); w != writer.end()) these.push_back(w->second);
  }
  return all;
}

// @param stage below 0 of the jobs that cannot begin: each waits for another of them.
[[noreturn]] void refuse_circle(std::span<const Job> jobs, const std::vector<Jobs>& awaits,
                                const std::vector<int>& stage) {
  const auto is_stuck = [&](std::size_t k) { return stage[k] < 0; };
  const auto next = [&](std::size_t k) { return *std::ranges::find_if(awaits[k], is_stuck); };
  auto first = std::size_t(std::ranges::find_if(stage, [](int s) { return s < 0; }) - stage.begin());
  for (std::size_t k = 0; k < jobs.size(); ++k) first = next(first);  // From here on, the circle.
  std::string circle = jobs[first].where;
  std::size_t k = first;
  for (int shown = 1; (k = next(k)) != first && shown < 8; ++shown) circle += ", " + jobs[k].where;
  throw envmap::UsageError(
      fmt::format("jobs wait for each other in a circle ({}, {}): let one of them read another file", circle,
                  k == first ? jobs[first].where : "..."));
}

// 0 of jobs that read what is there, one more of those that read what others write.
std::vector<int> stages(std::span<const Job> jobs) {
  const std::vector<Jobs> awaits = awaited(jobs);
  std::vector<int> stage(jobs.size(), -1);
  for (std::size_t known = 0; known < jobs.size();) {
    const std::size_t before = known;
    for (std::size_t k = 0; k < jobs.size(); ++k) {
      const auto is_known = [&](std::size_t other) { return stage[other] >= 0; };
      if (is_known(k) || !std::ranges::all_of(awaits[k], is_known)) continue;
      stage[k] = 0, ++known;
      for (const std::size_t other : awaits[k]) stage[k] = std::max(stage[k], stage[other] + 1);
    }
    if (known == before) refuse_circle(jobs, awaits, stage);
  }
  return stage;
}

}  // namespace

// Links to folders are followed, a link to a file is not: another file may take its place.
std::string plain_path(const std::string& path) {
  namespace fs = std::filesystem;
  const fs::path given = path, here = fs::current_path(), whole = fs::absolute(given);
  std::error_code error;
  const fs::path canonical = fs::weakly_canonical(whole.parent_path(), error),
                 known = (error ? whole.parent_path().lexically_normal() : canonical) / whole.filename(),
                 near = known.lexically_proximate(here);
  return (given.is_absolute() && near.string().starts_with("..") ? known : near).string();
}

void check_order(std::span<const Job> jobs) { stages(jobs); }

std::string quoted(const std::string& word) {
  constexpr std::string_view plain = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-+=./,:@%";
  if (!word.empty() && word.find_first_not_of(plain) == word.npos) return word;
  std::string out = "'";
  for (const char c : word) out += c == '\'' ? "'\\''" : std::string(1, c);
  return out + "'";
}

std::string ninja_file(std::span<const Job> jobs, const std::string& program, const std::string& folder) {
  std::string version = version_text();  // Another version may make other maps.
  std::ranges::replace(version, '\n', ' ');
  std::string text = fmt::format(
      "ninja_required_version = 1.5\n"
      "builddir = {}\n\n"
      "rule envmap\n"
      "  command = : {}; $run\n"
      "  description = $what\n"
      "  depfile = $dependencies\n"
      "  deps = gcc\n"
      "  restat = 1\n\n",
      escaped(folder, "$", '$'), escaped(tools::quoted(version), "$", '$'));
  const auto writer = writers(jobs);
  for (std::size_t k = 0; k < jobs.size(); ++k) {
    const Job& job = jobs[k];
    const std::string depfile = fmt::format("{}/{}.d", folder, k + 1);
    text += fmt::format("build {}: envmap {}\n  run = {}\n  what = {}\n  dependencies = {}\n",
                        joined(job.outputs, " ", for_ninja), joined(needed(job, writer), " ", for_ninja),
                        escaped(command(job, program, {"--quiet", "--if-changed", "--depfile", depfile}), "$", '$'),
                        escaped(joined(job.words, " ", quoted), "$", '$'), escaped(depfile, "$", '$'));
  }
  return text;
}

namespace {

// Of outputs, as words for sh, each after a space.
std::string folders_of(std::span<const Job> jobs) {
  std::set<std::string> folders;
  for (const Job& job : jobs)
    for (const std::string& file : job.outputs) folders.insert(std::filesystem::path(file).parent_path().string());
  folders.erase("");
  std::string words;
  for (const std::string& folder : folders) words += " " + quoted(folder);
  return words;
}

}  // namespace

std::string makefile(std::span<const Job> jobs, const std::string& program, const std::string& folder) {
  std::string all, rules, depfiles;
  const auto writer = writers(jobs);
  for (std::size_t k = 0; k < jobs.size(); ++k) {
    const Job& job = jobs[k];
    const std::string depfile = fmt::format("{}/{}.d", folder, k + 1);
    all += " " + joined(job.outputs, " ", for_make);
    depfiles += " " + for_make(depfile);
    rules += fmt::format("{} {}: {}\n\t{}\n\n", joined(job.outputs, " ", for_make), job.outputs.size() > 1 ? "&" : "",
                         joined(needed(job, writer), " ", for_make),
                         escaped(command(job, program, {"--quiet", "--depfile", depfile}), "$", '$'));
  }
  return fmt::format(
      "# Written by 'envmap batch'. Changed inputs make their maps again; after a change of the manifest write it "
      "anew, and make "
      "-B.\nall:{}\n\n{}$(shell mkdir -p -- {})\n-include{}\n.PHONY: all\n.DELETE_ON_ERROR:\n",
      all, rules, escaped(quoted(folder) + folders_of(jobs), "$", '$'), depfiles);
}

std::string slurm_script(std::span<const Job> jobs, const std::string& program) {
  const std::vector<int> stage = stages(jobs);
  std::vector<std::size_t> order(jobs.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, {}, [&](std::size_t k) { return stage[k]; });
  std::string cases;
  for (std::size_t n = 0; n < order.size(); ++n)
    cases += fmt::format("  {}) exec {} ;;\n", n + 1, command(jobs[order[n]], program, {"--quiet"}));
  constexpr std::size_t largest_array = 1000;  // Slurm's MaxArraySize is 1001 where nobody raised it.
  const std::string folders = folders_of(jobs);
  std::string submit = (folders.empty() ? "" : "  mkdir -p --" + folders + "\n") + "  before=\n";
  for (std::size_t n = 0; n < order.size();) {
    const int of = stage[order[n]];
    submit += "  these=\n";
    while (n < order.size() && stage[order[n]] == of) {
      std::size_t end = n;
      while (end < order.size() && end < n + largest_array && stage[order[end]] == of) ++end;
      submit += fmt::format(
          "  id=$(sbatch --parsable --array=1-{} --export=ALL,ENVMAP_FIRST={} ${{before:+--dependency=afterok$before}} "
          "\"$@\" \"$0\")\n"
          "  these=$these:${{id%%;*}}\n",
          end - n, n);
      n = end;
    }
    submit += "  before=$these\n";
  }
  return fmt::format(
      "#!/bin/sh\n"
      "#SBATCH --job-name=envmap\n"
      "#SBATCH --requeue\n"
      "# Written by 'envmap batch': {} jobs. 'sh THIS [OPTIONS OF SBATCH]' submits them and prints the ids of the "
      "last: jobs that\n"
      "# read what others write wait for these. Outputs appear whole or not at all: a job may be killed and queued "
      "again.\n"
      "set -eu\n"
      "if [ -z \"${{SLURM_ARRAY_TASK_ID:-}}\" ]; then\n{}  echo \"${{before#:}}\"\n  exit\nfi\n"
      "export ENVMAP_THREADS=\"${{SLURM_CPUS_PER_TASK:-1}}\"\n"
      "case $((SLURM_ARRAY_TASK_ID + ENVMAP_FIRST)) in\n{}esac\n",
      jobs.size(), submit, cases);
}

}  // namespace tools
