#include <tbb/global_control.h>

#include "cli/command_line.h"
#include "shared/maps.h"

namespace tools {

std::span<const Command> commands() {
  static constexpr Command all[] = {
      // name, reports, writes
      {"convert", true, true, define_convert},     {"mipmap", true, true, define_mipmap},
      {"prefilter", true, true, define_prefilter}, {"sh", true, true, define_sh},
      {"render", true, true, define_render},      {"view", false, true, define_view},
      {"info", true, false, define_info},          {"compare", true, true, define_compare},
      {"tradeoff", true, false, define_tradeoff},  {"generate", false, true, define_generate},
      {"preview", false, true, define_preview},    {"bake", true, true, define_bake},
      {"batch", false, false, define_batch},       {"merge", false, true, define_merge},
      {"manual", false, false, define_manual},     {"completion", false, false, define_completion},
  };
  return all;
}

Action define(const Command& command, Options& o, Settings& s) {
  o.flag("-h,--help", s.help, "Print this help message and exit");
  Action action = command.define(o);
  if (command.reports) o.flag("--json", s.json, "Report as JSON on standard output");
  if (command.writes) {
    o.add("--depfile", "FILE", &s.depfile, "Write what the output depends on, in Make syntax");
    o.flag("--if-changed", s.commit.if_changed,
           "Leave an output with the same bytes as it is, and its time: for restat of Ninja");
    o.flag("--force", s.commit.force, "Replace outputs that are read-only");
    o.flag("--fsync", s.commit.sync, "End when the outputs are on the disk, safe from a power cut");
  }
  o.add("--threads", "N", &s.threads, {1, 1024},
        "Threads to use; the result is the same for any number (default: all cores)")
      .environment = "ENVMAP_THREADS";
  o.flag("-q,--quiet", s.quiet, "No notes and no progress, only errors and what changes the result");
  o.flag("-v,--verbose", s.verbose, "Say what is done and how long it takes");
  return action;
}

int run(Parsed& parsed) {
  std::optional<tbb::global_control> limit;
  const Settings& s = settings();
  if (s.threads > 0) limit.emplace(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(s.threads));
  const PendingDepfile depfile;
  check_files(parsed.options.named(File::output), parsed.options.named(File::input));
  Report report;
  const int status = parsed.action(report);
  commit_depfile();
  if (s.json && !report.empty()) print(report.text());
  return status;
}

}  // namespace tools
