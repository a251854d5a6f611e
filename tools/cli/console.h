// Messages on standard error, and results on standard output.
#pragma once

#include <chrono>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "envmap/base/run.h"
#include "envmap/io/files/commit.h"

namespace tools {

/// The options that every command has. Set once, when the command line is read.
struct Settings {
  int threads = 0;  ///< 0: all cores.
  bool quiet = false, verbose = false, json = false, help = false;
  std::string depfile;
  envmap::CommitOptions commit;
  std::vector<std::string> also_read;  ///< Files that the user did not name, such as colour configs. For the depfile.
};
Settings& settings();

void warn(std::string_view line);    ///< Always shown: the result is not what was asked for.
void note(std::string_view line);    ///< Shown unless --quiet.
void detail(std::string_view line);  ///< Shown with --verbose, unless --quiet.
void print(std::string_view text);  ///< Writes to standard output. main() checks once, at the end, whether that worked.

/// Bytes of the UTF-8 character at the beginning of a text, which is not empty. 0: the bytes there are no character.
std::size_t utf8_length(std::string_view text);
/// Replaces control characters and invalid UTF-8: names come from users and from files. Line breaks stay.
std::string printable(std::string_view text);
/// The same, escaped for SVG and HTML, as text or between double quotes.
std::string in_markup(std::string_view text);

/// Shows how much is done and the time left, on standard error: on a terminal where the work takes over a second, and
/// else a line every ten seconds.
envmap::Progress progress_line(const std::string& what);

/// Measures the time since it was made.
class Stopwatch {
 public:
  [[nodiscard]] double seconds() const { return std::chrono::duration<double>(Clock::now() - start_).count(); }

 private:
  using Clock = std::chrono::steady_clock;
  Clock::time_point start_ = Clock::now();
};

}  // namespace tools
