// Words as pixels, by FreeType.
#pragma once

#include <string>
#include <string_view>

#include "drawing/contact_sheet.h"

namespace tools {

// The font's file, looked up once in the fonts folders of the XDG base directories; empty if there is none.
const std::string& font_file();

inline constexpr const char* install_font = "install the package of DejaVu Sans (Debian: fonts-dejavu-core)";

// Of a line of text, in pixels. @throws OutputError where font_file() cannot be used.
int width_of_letters(std::string_view text, int height);

// Draws a line of text over a picture in light grey, its left end and baseline at (x, y). Letters that the font lacks
// are its boxes.
// @param text UTF-8. @param height of the letters in pixels. @throws OutputError where font_file() cannot be used.
void draw_letters(Picture& onto, int x, int y, std::string_view text, int height);

}  // namespace tools
