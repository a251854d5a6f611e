// What the program says: to people on standard error, to people and programs on standard output.
#include <fmt/format.h>
#include <unistd.h>

#include <chrono>
#include <cmath>
#include <cstdio>
#include <mutex>

#include "command.h"
#include "envmap/base/error.h"

namespace tools {
namespace {

using nlohmann::ordered_json;

// Bytes of the UTF-8 character that begins there; 0 where none does.
std::size_t length_of(std::string_view text) {
  const auto lead = static_cast<unsigned char>(text[0]);
  const std::size_t length = lead < 0x80 ? 1 : lead < 0xc2 ? 0 : lead < 0xe0 ? 2 : lead < 0xf0 ? 3 : lead < 0xf5 ? 4 : 0;
  if (length > text.size()) return 0;
  for (std::size_t k = 1; k < length; ++k)
    if ((static_cast<unsigned char>(text[k]) & 0xc0) != 0x80) return 0;
  return length;
}

// Of ASCII and of ISO 8859 (U+0080 to U+009F), which terminals obey, too.
bool is_control(std::string_view character) {
  const auto first = static_cast<unsigned char>(character[0]);
  return (first < ' ' && first != '\n' && first != '\t') || first == 0x7f ||
         (first == 0xc2 && static_cast<unsigned char>(character[1]) < 0xa0);
}

void make_finite(ordered_json& value, const std::string& place, ordered_json& not_finite) {
  if (value.is_number_float()) {
    const double x = value.get<double>();
    if (std::isfinite(x)) return;
    not_finite[place] = std::isnan(x) ? "nan" : x > 0 ? "infinite" : "-infinite";
    value = nullptr;
  } else if (value.is_array()) {
    for (std::size_t k = 0; k < value.size(); ++k) make_finite(value[k], fmt::format("{}/{}", place, k), not_finite);
  } else if (value.is_object()) {
    for (auto& [key, member] : value.items()) make_finite(member, place + "/" + key, not_finite);
  }
}

std::string in_words(double seconds) {
  const int whole = static_cast<int>(std::min(seconds, 1e6));
  return whole < 60 ? fmt::format("{} s", whole) : fmt::format("{}:{:02} min", whole / 60, whole % 60);
}

}  // namespace

std::string printable(std::string_view text) {
  std::string out;
  while (!text.empty()) {
    const std::size_t length = length_of(text);
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

void print_report(ordered_json report) {
  ordered_json all, not_finite = ordered_json::object();
  all["version"] = 1;
  for (auto& [key, value] : report.items()) all[key] = std::move(value);
  make_finite(all, "", not_finite);
  if (!not_finite.empty()) all["not_finite"] = std::move(not_finite);
  constexpr bool only_ascii = true;
  print(all.dump(2, ' ', only_ascii, ordered_json::error_handler_t::replace) + "\n");
}

void check_report(const std::string& output, const Common& common) {
  if (common.json && output == "-") throw envmap::UsageError("--json and the output would both be standard output: name a file");
}

void add_written(ordered_json& report, const std::string& path, const envmap::Written& written) {
  report["output"] = path;
  report["depth"] = name(written.depth);
  report["clamped"] = written.clamped;
  report["flux_lost"] = written.flux_lost;
}

std::vector<Key> with_written(std::vector<Key> keys) {
  keys.insert(keys.end(), {{"output", "text or null", "OUTPUT; null where nothing was written"},
                           {"depth", "text?", "what it holds: uint8, uint16, bc6h, rgb9e5, half or float; absent, as the next two, where nothing was written"},
                           {"clamped", "count?", "texels that --clamp changed"},
                           {"flux_lost", "number?", "part of the flux that this took"}});
  return keys;
}

void warn(std::string_view line) { std::fputs((printable(line) + "\n").c_str(), stderr); }

void note(const Common& common, std::string_view line) {
  if (!common.quiet) warn(line);
}

envmap::Progress progress_line(const Common& common, const std::string& what) {
  if (common.quiet || !::isatty(STDERR_FILENO)) return {};
  using Clock = std::chrono::steady_clock;
  struct State {
    std::mutex mutex;
    Clock::time_point start = Clock::now();
    int shown = -1;
    ~State() {
      if (shown >= 0) std::fputs("\r\033[K", stderr);
    }
  };
  return [state = std::make_shared<State>(), what](double part) {
    const std::lock_guard lock(state->mutex);
    const int percent = static_cast<int>(100 * part);
    const double seconds = std::chrono::duration<double>(Clock::now() - state->start).count();
    if (percent <= state->shown || seconds < 1) return;
    state->shown = percent;
    const std::string left =
        percent > 0 ? fmt::format(", {:.2g}%/s, {} left", 100 * part / seconds, in_words(seconds * (1 - part) / part)) : "";
    std::fputs(fmt::format("\r{} {:3d}%{}\033[K", what, percent, left).c_str(), stderr);
  };
}

ordered_json to_json(const envmap::Direction& v) { return {v.x, v.y, v.z}; }

}  // namespace tools
