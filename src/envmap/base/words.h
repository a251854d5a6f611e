/// @file
/// Lists in messages and help texts.
#pragma once

#include <fmt/format.h>

#include <functional>
#include <span>
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

/// The words of some things, with `between` between them.
template <class Things, class Word = std::identity>
std::string joined(const Things& things, std::string_view between, Word word_of = {}) {
  std::string text;
  bool first = true;
  for (const auto& thing : things) {
    text += fmt::format("{}{}", first ? "" : between, std::invoke(word_of, thing));
    first = false;
  }
  return text;
}

/// "a, b or c".
template <class Things>
std::string enumerated(const Things& things, std::string_view last = " or ") {
  const std::span all(things);
  const std::string most = joined(all.first(all.empty() ? 0 : all.size() - 1), ", ");
  return all.empty() ? "" : fmt::format("{}{}{}", most, most.empty() ? "" : last, all.back());
}

/// "a, b ...": so many that a line stays a line.
inline std::string some_of(std::span<const std::string> names) {
  constexpr std::size_t most = 60;
  std::string list;
  for (const std::string& name : names) {
    if (list.size() >= most) return list + " ...";
    list += (list.empty() ? "" : ", ") + name;
  }
  return list;
}

}  // namespace envmap
