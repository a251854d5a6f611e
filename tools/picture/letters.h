// Words as pixels, by FreeType.
#pragma once

#include <string>
#include <string_view>

#include "picture/contact_sheet.h"

namespace tools {

// Draws a line of text over a picture in light grey, its left end and baseline at (x, y). Letters that the font lacks
// are its boxes.
// @param text UTF-8. @param height of the letters in pixels. @throws OutputError where the font cannot be used.
void draw_letters(Picture& onto, int x, int y, std::string_view text, int height, const std::string& font);

}  // namespace tools
