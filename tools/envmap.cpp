// The program: parses, runs one command, turns what goes wrong into one line and an exit status.
#include <fmt/format.h>
#include <tbb/global_control.h>

#include <cstdio>
#include <new>
#include <optional>

#include "command.h"
#include "envmap/base/error.h"
#include "suggest.h"

namespace {

enum Status { done = 0, usage = 2, bad_input = 3, not_written = 4, no_renderer = 5 };

int complain(const std::string& who, std::string what, int status) {
  std::replace(what.begin(), what.end(), '\n', ' ');
  std::fputs((who + ": " + what + "\n").c_str(), stderr);
  return status;
}

int run_with_threads(const std::function<int()>& run, int threads) {
  std::optional<tbb::global_control> limit;
  if (threads > 0) limit.emplace(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(threads));
  return run();
}

}  // namespace

int main(int argc, char** argv) {
  const std::vector<tools::Command> commands = tools::all_commands();
  tools::Common common;
  std::function<int()> run;
  const auto app = tools::make_app(commands, common, run);
  std::string who = "envmap";
  if (argc > 1 && tools::find_command(*app, argv[1]) != nullptr) who += std::string(" ") + argv[1];
  try {
    app->parse(argc, argv);
  } catch (const CLI::Success& e) {  // --help, --version
    return app->exit(e);
  } catch (const CLI::ParseError& e) {
    return complain(who, tools::explain(e, *app, argc, argv), usage);
  }
  try {
    const int status = run_with_threads(run, common.threads);
    if (std::fflush(stdout) != 0 || std::ferror(stdout) != 0)
      return complain(who, "standard output: not written", not_written);
    return status;
  } catch (const CLI::ParseError& e) {
    return complain(who, e.what(), usage);
  } catch (const envmap::UsageError& e) {
    return complain(who, e.what(), usage);
  } catch (const envmap::InputError& e) {
    return complain(who, e.what(), bad_input);
  } catch (const envmap::OutputError& e) {
    return complain(who, e.what(), not_written);
  } catch (const envmap::RendererError& e) {
    return complain(who, e.what(), no_renderer);
  } catch (const std::bad_alloc&) {
    return complain(who, "not enough memory: choose a smaller --size", not_written);
  } catch (const std::exception& e) {
    return complain(who, fmt::format("{} (this is a fault of envmap: please report it)", e.what()), bad_input);
  }
}
