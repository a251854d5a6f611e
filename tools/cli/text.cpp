#include "cli/text.h"

#include <fmt/format.h>

#include "cli/embedded.h"
#include "cli/options.h"
#include "envmap/sample/filter.h"

namespace tools {
namespace {

std::string filled(std::string line) {
  constexpr std::string_view mark = "{filters}";
  const std::size_t at = line.find(mark);
  if (at == line.npos) return line;
  std::string filters;
  for (const envmap::FilterInfo& f : envmap::filters())
    filters += fmt::format("{}'{}' {}.", filters.empty() ? "" : " ", f.name, f.summary);
  return line.replace(at, mark.size(), filters);
}

std::string trimmed(const std::string& s) { return s.substr(0, s.find_last_not_of(' ') + 1); }

void read(std::string_view name, Text& text) {
  for (const std::string& line : split(std::string(text_file(std::string(name) + ".txt")), '\n')) {
    const std::size_t first = line.find(" | "), second = line.find(" | ", first + 1);
    if (line.empty()) continue;
    if (line.starts_with('+')) {
      read(line.substr(1), text);
    } else if (line.starts_with("$ ")) {
      text.examples.push_back({line.substr(2), ""});
    } else if (!text.examples.empty() && text.examples.back().what.empty()) {
      text.examples.back().what = line;
    } else if (second != std::string::npos) {
      text.keys.push_back({trimmed(line.substr(0, first)), trimmed(line.substr(first + 3, second - first - 3)),
                           line.substr(second + 3)});
    } else if (text.summary.empty()) {
      text.summary = line;
    } else if (line.starts_with("  ") && !text.description.empty()) {
      text.description.back() += "\n" + line;
    } else {
      text.description.push_back(filled(line));
    }
  }
}

}  // namespace

Text text_of(std::string_view command) {
  Text text;
  text.keys.push_back({"version", "one", "1; another where a key changes its meaning or is gone"});
  read(command, text);
  text.keys.push_back(
      {"not_finite", "flaws?",
       "absent, or for each number that is not finite its JSON pointer and what it is: infinite, -infinite or nan"});
  return text;
}

}  // namespace tools
