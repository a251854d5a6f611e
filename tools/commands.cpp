#include <tbb/global_control.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>

#include "cli/command_line.h"
#include "envmap/base/error.h"
#include "envmap/io/files/output_file.h"
#include "maps/depfile.h"

namespace tools {

std::span<const Command> commands() {
  static constexpr Command all[] = {
      // name, reports, writes
      {"convert", true, true, define_convert},
      {"mipmap", true, true, define_mipmap},
      {"prefilter", true, true, define_prefilter},
      {"sh", true, true, define_sh},
      {"render", true, true, define_render},
      {"view", true, true, define_view},
      {"info", true, false, define_info},
      {"compare", true, true, define_compare},
      {"tradeoff", true, false, define_tradeoff},
      {"generate", true, true, define_generate},
      {"preview", false, true, define_preview},
      {"lights", true, true, define_lights},
      {"bake", true, true, define_bake},
      {"batch", false, false, define_batch},
      {"merge", false, true, define_merge, "join"},
      {"manual", false, false, define_manual},
      {"completion", false, false, define_completion},
  };
  return all;
}

Action define(const Command& command, Options& o, Settings& s) {
  Action action = command.define(o);
  o.group = groups::builds;
  if (const bool runs_jobs = o.has("--jobs"); command.reports || command.writes || runs_jobs)
    o.add("--threads", "N", &s.threads, {1, 1024},
          runs_jobs ? "Threads of each job, without effect on the output (default: cores / jobs)"
                    : "Threads, without effect on the output (default: all cores)")
        .environment = "ENVMAP_THREADS";
  if (command.writes) {
    o.add("--depfile", "FILE", &s.depfile, "Write the dependencies of the output in Make syntax");
    o.flag("--if-changed", s.commit.if_changed, "Keep an output with unchanged content, and its modification time");
    o.flag("--force", s.commit.force, "Replace read-only outputs");
    o.flag("--fsync", s.commit.sync, "Flush outputs to disk before exiting").folded = true;
    if (const Option* const output = o.output(); output != nullptr && !output->is_argument())
      o.need(output->name, {"--depfile", "--if-changed", "--force", "--fsync"});
  }
  // Only where there is one does --forward say something of the input, too.
  if (const auto from = std::ranges::find(o.rows, "--from-forward", &Option::name);
      from != o.rows.end() && std::ranges::find(o.rows, "--forward", &Option::name) == o.rows.end())
    from->help.erase(from->help.find(" --forward,"), std::string_view(" --forward,").size());
  o.group = groups::reports;
  if (command.reports) o.flag("--json", s.json, "Print a JSON report on standard output");
  o.flag("-q,--quiet", s.quiet, "Print no notes and no progress");
  o.flag("-v,--verbose", s.verbose, "Print each step and its time");
  o.flag("-h,--help", s.help, "-h prints the main options, --help all");
  return action;
}

namespace {

// Bytes of maps and pictures are nothing to look at.
void check_terminal(const Options& o) {
  const Option* const output = o.output();
  if (output != nullptr && output->is_argument() && !o.given(output->all_inputs_with) && !output->given.empty() &&
      output->given.back() == "-" && ::isatty(STDOUT_FILENO) != 0)
    throw envmap::UsageError("-: standard output is a terminal: redirect it, or give a file name");
}

// Before the work, not after it. Marks in the folder's name are not known yet.
void check_folders(const std::vector<std::string>& outputs) {
  for (const std::string& output : outputs)
    if (std::filesystem::path(output).parent_path().string().find_first_of("{%") == std::string::npos)
      envmap::require_folder_of(output);
}

}  // namespace

int run(Parsed& parsed) {
  std::optional<tbb::global_control> limit;
  const Settings& s = settings();
  if (s.threads > 0) limit.emplace(tbb::global_control::max_allowed_parallelism, std::size_t(s.threads));
  const PendingDepfile depfile;
  const Options& o = parsed.options;
  // Where the last argument is the output, the command looks first whether there is one.
  if (std::ranges::find(o.rows, File::inputs_then_output, &Option::file) == o.rows.end())
    check_files(o.named(File::output), o.named(File::input), {o.last("--faces"), o.last("--from-faces")});
  check_folders(o.named(File::output));
  check_terminal(o);
  Report report;
  const int status = parsed.action(report);
  commit_depfile();
  if (s.json && !report.empty()) print(report.text());
  return status;
}

}  // namespace tools
