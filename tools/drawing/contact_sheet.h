// Pictures put together on one sheet, each above its caption.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "envmap/io/images/image_writer.h"
#include "envmap/maths/vector.h"

namespace tools {

// An image as it is stored: sRGB encoded, 0 to 1, rows from the top.
struct Picture {
  envmap::Size size;
  std::vector<envmap::Colour> pixels;

  Picture(envmap::Size s, envmap::Colour fill) : size(s), pixels(std::size_t(s.width) * std::size_t(s.height), fill) {}
  [[nodiscard]] auto row(int x, int y) { return pixels.begin() + std::ptrdiff_t{y} * size.width + x; }
  [[nodiscard]] envmap::Colour& at(int x, int y) { return *row(x, y); }
  [[nodiscard]] bool holds(int x, int y) const { return x >= 0 && y >= 0 && x < size.width && y < size.height; }
};

struct Tile {
  Picture picture;
  std::string caption;
};
using TileRow = std::vector<Tile>;

inline constexpr int sheet_border = 8;

// Rows of so many, each tile in the middle of a cell; all cells are as wide as the widest.
std::vector<TileRow> in_columns(std::vector<Tile> tiles, int columns);

Picture sheet_of(std::span<const TileRow> rows);

// A line of text on a darkened ground, its middle at (x, y) or as near as it fits into the picture.
void draw_label(Picture& picture, int x, int y, const std::string& text, int height);

// A circle of two pixels, dark outside and light inside, so that it is seen on any ground.
void draw_ring(Picture& picture, double x, double y, double radius);

}  // namespace tools
