/// @file
/// A text in parts.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace envmap {

/// The parts of a text between the marks: one more than there are marks.
inline std::vector<std::string> split(std::string_view text, char mark) {
  std::vector<std::string> parts(1);
  for (const char c : text)
    if (c == mark)
      parts.emplace_back();
    else
      parts.back() += c;
  return parts;
}

}  // namespace envmap
