#include "cli/console.h"

#include <fmt/format.h>
#include <unistd.h>

#include <chrono>
#include <cmath>
#include <cstdio>
#include <mutex>

namespace tools {
namespace {

// Of ASCII and of ISO 8859 (U+0080 to U+009F), which terminals obey, too.
bool is_control(std::string_view character) {
  const auto first = static_cast<unsigned char>(character[0]);
  return (first < ' ' && first != '\n' && first != '\t') || first == 0x7f ||
         (first == 0xc2 && static_cast<unsigned char>(character[1]) < 0xa0);
}

constexpr double log_interval = 10;  // Seconds between lines of progress in a log.

std::string in_words(double seconds) {
  const int whole = int(std::min(seconds, 1e6));
  return whole < 60 ? fmt::format("{} s", whole) : fmt::format("{}:{:02} min", whole / 60, whole % 60);
}

}  // namespace

Settings& settings() {
  static Settings all;
  return all;
}

std::size_t utf8_length(std::string_view text) {
  const auto lead = static_cast<unsigned char>(text[0]);
  const std::size_t length = lead < 0x80   ? 1
                             : lead < 0xc2 ? 0
                             : lead < 0xe0 ? 2
                             : lead < 0xf0 ? 3
                             : lead < 0xf5 ? 4
                                           : 0;
  if (length > text.size()) return 0;
  for (std::size_t k = 1; k < length; ++k)
    if ((static_cast<unsigned char>(text[k]) & 0xc0) != 0x80) return 0;
  return length;
}

std::string printable(std::string_view text) {
  std::string out;
  while (!text.empty()) {
    const std::size_t length = utf8_length(text);
    const std::string_view character = text.substr(0, std::max<std::size_t>(1, length));
    if (length == 0 || is_control(character))
      out += '?';
    else
      out += character;
    text.remove_prefix(character.size());
  }
  return out;
}

std::string in_markup(std::string_view text) {
  std::string out;
  for (const char c : printable(text))
    out += c == '<' ? "&lt;" : c == '>' ? "&gt;" : c == '&' ? "&amp;" : c == '"' ? "&quot;" : std::string(1, c);
  return out;
}

void print(std::string_view text) { std::fputs(printable(text).c_str(), stdout); }

void warn(std::string_view line) { std::fputs((printable(line) + "\n").c_str(), stderr); }

void note(std::string_view line) {
  if (!settings().quiet) warn(line);
}

void detail(std::string_view line) {
  if (settings().verbose) note(line);
}

envmap::Progress progress_line(const std::string& what) {
  if (settings().quiet) return {};
  using Clock = std::chrono::steady_clock;
  struct State {
    std::mutex mutex;
    Clock::time_point start = Clock::now();
    bool on_terminal = ::isatty(STDERR_FILENO) != 0;
    int shown = -1;
    double next = on_terminal ? 1 : log_interval;  // Seconds after the start.
    ~State() {
      if (on_terminal && shown >= 0) std::fputs("\r\033[K", stderr);
    }
  };
  return [state = std::make_shared<State>(), what](double part) {
    const std::lock_guard lock(state->mutex);
    const int percent = int(100 * part);
    const double seconds = std::chrono::duration<double>(Clock::now() - state->start).count();
    if (percent <= state->shown || seconds < state->next) return;
    state->shown = percent;
    if (!state->on_terminal) state->next = seconds + log_interval;
    const double rate = part / seconds;
    const std::string left =
        percent > 0 ? fmt::format(", {:.2g}%/s, {} left", 100 * rate, in_words((1 - part) / rate)) : "";
    const std::string line = fmt::format("{} {:3d}%{}", what, percent, left);
    std::fputs((state->on_terminal ? "\r" + line + "\033[K" : line + "\n").c_str(), stderr);
  };
}

}  // namespace tools
