#include "cli/text.h"

#include <fmt/format.h>

#include <algorithm>

#include "cli/embedded.h"
#include "cli/options.h"
#include "engines/engine_options.h"
#include "envmap/base/words.h"
#include "envmap/io/face_files.h"
#include "envmap/io/formats/file_format.h"
#include "envmap/sample/filter.h"

namespace tools {
namespace {

void list_filters(std::vector<std::string>& paragraphs) {
  for (const envmap::FilterInfo& f : envmap::filters())
    paragraphs.push_back(fmt::format("* {}: {}.", f.name, f.summary));
}

// Rows of a table about engines, formats or names of faces.
std::string table_rows(const std::string& mark) {
  std::string rows;
  if (mark == "{engines}")
    for (const envmap::Engine& e : envmap::engines())
      rows += fmt::format("\n| `{}` {} | {} | {} | {} | {} |", e.name, e.title, image_of(e), e.axes, e.mirrored,
                          was_run(e) ? "yes" : "no");
  if (mark == "{faces}")
    for (const envmap::FaceConvention& c : envmap::face_conventions()) {
      std::string files(c.files);
      std::ranges::replace(files, ',', ' ');
      rows += fmt::format("\n| `{}` | {} | {} |", c.name, files, c.title);
    }
  if (mark == "{formats}")
    for (const envmap::FileFormat& f : envmap::file_formats()) {
      std::string extensions = f.extensions.empty() ? "no" : "", depths = f.is_written() ? "" : "no";
      for (const std::string_view e : f.extensions)
        extensions += fmt::format("{}.{}", extensions.empty() ? "" : " ", e);
      for (const envmap::Depth d : f.depths) depths += fmt::format("{}{}", depths.empty() ? "" : " ", name(d));
      rows += fmt::format("\n| {} | {} | {} | {} |", f.title, extensions, depths, f.levels ? "yes" : "no");
    }
  return rows;
}

// {depths}, {formats} and {projections} stand for words of the library's tables.
std::string with_lists(std::string line) {
  using namespace envmap;
  const auto put = [&](std::string_view mark, const auto& table, const auto& name_of) {
    const std::size_t at = line.find(mark);
    if (at == line.npos) return;
    std::vector<std::string_view> words;
    for (const auto& row : table)
      if (std::ranges::find(words, std::string_view(name_of(row))) == words.end()) words.emplace_back(name_of(row));
    line.replace(at, mark.size(), envmap::enumerated(words));
  };
  put("{depths}", depth_names, [](std::string_view name) { return name; });
  put("{formats}", file_formats(), [](const FileFormat& f) { return f.name; });
  put("{projections}", all_projections, [](Projection p) { return name(p); });
  return line;
}

std::string trimmed(const std::string& s) { return s.substr(0, s.find_last_not_of(' ') + 1); }

void read(std::string_view name, Text& text) {
  for (const std::string& line : split(std::string(text_file(std::string(name) + ".txt")), '\n')) {
    const std::size_t first = line.find(" | "), second = line.find(" | ", first + 1);
    if (line.empty()) continue;
    const bool in_table = !text.description.empty() && text.description.back().starts_with("| ");
    if (line == "{filters}") {
      list_filters(text.description);
    } else if (line.starts_with("{")) {
      text.description.back() += table_rows(line);
    } else if (line.starts_with("| ") && in_table) {
      text.description.back() += "\n" + line;
    } else if (line.starts_with("| ")) {
      text.description.push_back(line);
    } else if (line.starts_with('+')) {
      read(line.substr(1), text);
    } else if (const std::size_t colon = line.find(": "); line.starts_with("--") && line.find(' ') == colon + 1) {
      text.details.emplace(line.substr(0, colon), line.substr(colon + 2));
    } else if (line.starts_with("$ ")) {
      text.examples.push_back({line.substr(2), ""});
    } else if (!text.examples.empty() && text.examples.back().what.empty()) {
      text.examples.back().what = line;
    } else if (second != std::string::npos) {
      text.keys.push_back({trimmed(line.substr(0, first)), trimmed(line.substr(first + 3, second - first - 3)),
                           with_lists(line.substr(second + 3))});
    } else if (text.summary.empty()) {
      text.summary = line;
    } else if (line.starts_with("  ") && !text.description.empty()) {
      text.description.back() += "\n" + line;
    } else {
      text.description.push_back(line);
    }
  }
}

}  // namespace

Text text_of(std::string_view command) {
  Text text;
  text.keys.push_back({"version", "one", "1; another where a key changes its meaning or is gone"});
  read(command, text);
  read("options", text);
  text.keys.push_back(
      {"not_finite", "flaws?",
       "absent, or for each number that is not finite its JSON pointer and what it is: infinite, -infinite or nan"});
  return text;
}

}  // namespace tools
