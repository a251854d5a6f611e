/// @file
/// The words that were probably meant.
#pragma once

#include <string>
#include <vector>

namespace envmap {

/// Known words that few letters tell from `word`, nearest first; capitals count as small letters.
/// @param most so many at most.
std::vector<std::string> near_words(const std::string& word, const std::vector<std::string>& known, std::size_t most);

}  // namespace envmap
