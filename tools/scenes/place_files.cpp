#include "scenes/place_files.h"

#include <fmt/format.h>

#include <algorithm>
#include <string_view>

#include "envmap/base/error.h"

namespace tools {
namespace {

using namespace envmap;

constexpr std::string_view place_mark = "{at}", index_mark = "{index}";

void replace(std::string& name, std::string_view mark, const std::string& by) {
  for (auto at = name.find(mark); at != name.npos; at = name.find(mark, at + by.size()))
    name.replace(at, mark.size(), by);
}

// A name in a folder, without what other marks are made of.
std::string as_file(std::string place) {
  const auto ends_names = [](unsigned char c) {
    return c < 32 || std::string_view("/\\{}%").find(static_cast<char>(c)) != std::string_view::npos;
  };
  std::ranges::replace_if(place, ends_names, '_');
  return place;
}

}  // namespace

std::vector<std::string> place_files(const std::string& output, const std::vector<std::string>& places) {
  const bool marked = output.find(place_mark) != output.npos || output.find(index_mark) != output.npos;
  if (places.empty() && marked) throw UsageError(output, "{at} and {index} in a name go with --at");
  if (places.empty()) return {output};
  std::vector<std::string> files;
  for (const std::string& place : places) {
    std::string& file = files.emplace_back(output);
    replace(file, place_mark, as_file(place));
    replace(file, index_mark, std::to_string(files.size() - 1));
    if (std::ranges::find(files.begin(), files.end() - 1, file) == files.end() - 1) continue;
    if (!marked)
      throw UsageError(fmt::format("{}: the name must contain {{at}} or {{index}} for several --at", output));
    throw UsageError(fmt::format("{}: two places have this name: put {{index}} into OUTPUT", file));
  }
  return files;
}

}  // namespace tools
