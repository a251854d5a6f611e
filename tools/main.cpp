// The program: parses, runs one command, turns what goes wrong into one line and an exit status.
#include <fmt/format.h>
#include <hwy/highway.h>

#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <new>
#include <string>
#include <string_view>

#include "cli/command_line.h"
#include "cli/failure.h"
#include "envmap/base/error.h"

using namespace tools;

int main(int argc, char** argv) {
  // For tests that the bytes do not depend on the processor: the vector code that every x86-64 can run.
  if (std::getenv("ENVMAP_BASELINE") != nullptr) hwy::DisableTargets(~std::int64_t{HWY_STATIC_TARGET});
  Parsed parsed;
  std::string who = "envmap";
  int status = done;
  try {
    const auto is_meant = [&](const Command& c) { return c.is_named(argv[1]); };
    if (argc > 1 && std::ranges::any_of(commands(), is_meant)) who += " " + std::string(argv[1]);
    parse({argv + 1, argv + argc}, parsed);
    status = run(parsed);
  } catch (const HelpRequested& asked) {
    std::fputs(asked.text.c_str(), stdout);
  } catch (const envmap::Error& e) {
    return report_error(who, words_of(e, parsed.options), status_of(e.code()));
  } catch (const std::bad_alloc&) {
    const bool sized = parsed.options.has("--size");
    return report_error(who, sized ? "not enough memory: choose a smaller --size" : "not enough memory", not_written);
  } catch (const std::exception& e) {
    return report_error(who, fmt::format("{} (this is a fault of envmap: please report it)", e.what()), bad_input);
  }
  if (std::fflush(stdout) != 0 || std::ferror(stdout) != 0)
    return report_error(who, "standard output: not written", not_written);
  return status;
}
