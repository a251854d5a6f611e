// The commands, each a row. A command defines its options once, for parsing, --help, man page and completions.
#pragma once

#include <functional>
#include <span>
#include <string_view>

#include "cli/console.h"
#include "cli/options.h"
#include "cli/report.h"

namespace tools {

/// What a command does after its options are read. @return the exit status.
using Action = std::function<int(Report& report)>;

struct Command {
  std::string_view name;  ///< text/NAME.txt holds its help texts.
  bool reports, writes;   ///< Has --json; has --depfile, --if-changed and --fsync.
  Action (*define)(Options& options);
  std::string_view alias = {};  ///< Another name; empty: it has none.

  [[nodiscard]] bool is_named(std::string_view word) const { return !word.empty() && (word == name || word == alias); }
};

Action define_bake(Options& options);
Action define_batch(Options& options);
Action define_compare(Options& options);
Action define_completion(Options& options);
Action define_convert(Options& options);
Action define_generate(Options& options);
Action define_info(Options& options);
Action define_lights(Options& options);
Action define_manual(Options& options);
Action define_merge(Options& options);
Action define_mipmap(Options& options);
Action define_prefilter(Options& options);
Action define_preview(Options& options);
Action define_render(Options& options);
Action define_sh(Options& options);
Action define_tradeoff(Options& options);
Action define_view(Options& options);

/// In the order of --help.
std::span<const Command> commands();

/// Adds the options of a command, and then those of every command. @param settings receives the latter.
Action define(const Command& command, Options& options, Settings& settings = tools::settings());

}  // namespace tools
