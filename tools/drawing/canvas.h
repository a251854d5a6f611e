// Lines, areas and text on white, to be written as an SVG or as a picture.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "drawing/contact_sheet.h"
#include "envmap/maths/vector.h"

namespace tools {

using Place = envmap::Point2;  // In units of the page, y down.

// A polygon, or a line where it is not filled.
struct Outline {
  std::vector<Place> points;
  std::optional<std::uint32_t> fill = {}, stroke = {};  // 0xRRGGBB, as sRGB.
  double width = 1;                                     // Of the stroke.
  bool closed = false, dashed = false;
};

enum class Anchor { start, middle, end };

struct Words {
  Place at;  // The baseline's start, middle or end.
  std::string text;
  double size = 12;
  Anchor anchor = Anchor::start;
  bool upwards = false;  // Turned to be read from the right.
};

// Words lie above all outlines, on a white rim of their own.
struct Drawing {
  double width, height;
  std::vector<Outline> outlines;
  std::vector<Words> words;
};

// How wide a text is at most in DejaVu Sans, the widest of the common fonts without serifs.
double width_of(const std::string& text, double size);

std::string svg_of(const Drawing& drawing);

// @param scale pixels a unit. @throws OutputError, without a file's name, where this machine has no font.
Picture picture_of(const Drawing& drawing, int scale);

}  // namespace tools
