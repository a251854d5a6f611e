// The font that writes words into pictures.
#pragma once

#include <string>

namespace tools {

// A file, looked up once in the fonts folders of the XDG base directories; empty if there is none.
const std::string& font_file();

inline constexpr const char* install_font = "install the package of DejaVu Sans (Debian: fonts-dejavu-core)";

}  // namespace tools
