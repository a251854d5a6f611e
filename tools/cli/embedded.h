// Files that are built into the program as text. cmake/embed.cmake writes the functions.
#pragma once

#include <string_view>

namespace tools {

/// @param name of a file of text/, or of page/. @return its contents; empty for other names.
std::string_view text_file(std::string_view name);
std::string_view page_source(std::string_view name);

}  // namespace tools
