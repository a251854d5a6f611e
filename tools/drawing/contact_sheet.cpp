#include "drawing/contact_sheet.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <mutex>

#include "cli/console.h"
#include "drawing/letters.h"

namespace tools {
namespace {

using namespace envmap;

constexpr Colour ground(0.12F);
constexpr int caption_room = 22, caption_height = 14;

void paste(Picture& onto, Picture& from, int x, int y) {
  for (int j = 0; j < from.size.height; ++j) std::copy_n(from.row(0, j), from.size.width, onto.row(x, y + j));
}

void write(Picture& onto, int x, int y, const std::string& text, int height) {
  if (!font_file().empty()) return draw_letters(onto, x, y, text, height);
  static std::once_flag told;
  std::call_once(told, [] { warn(fmt::format("no font, so the picture has no words: {}", install_font)); });
}

// A caption that is too wide ends after a word, with three dots.
std::string fitted(std::string text, int width) {
  const auto fits = [&](const std::string& t) { return width_of_letters(t, caption_height) <= width; };
  if (font_file().empty() || fits(text)) return text;
  for (auto end = text.rfind(' '); end != text.npos; end = text.rfind(' ')) {
    text.resize(end);
    if (fits(text + "...")) return text + "...";
  }
  return text;
}

int row_height(const TileRow& row) {
  int most = 0;
  for (const Tile& tile : row) most = std::max(most, tile.picture.size.height);
  return most + caption_room;
}

int row_width(const TileRow& row) {
  int sum = sheet_border;
  for (const Tile& tile : row) sum += tile.picture.size.width + sheet_border;
  return sum;
}

}  // namespace

std::vector<TileRow> in_columns(std::vector<Tile> tiles, int columns) {
  int cell = 0;
  for (const Tile& tile : tiles) cell = std::max(cell, tile.picture.size.width);
  std::vector<TileRow> rows;
  for (std::size_t k = 0; k < tiles.size(); ++k) {
    if (k % std::size_t(columns) == 0) rows.emplace_back();
    Picture& picture = tiles[k].picture;
    Picture centred({cell, picture.size.height}, ground);
    paste(centred, picture, (cell - picture.size.width) / 2, 0);
    rows.back().push_back({std::move(centred), std::move(tiles[k].caption)});
  }
  return rows;
}

Picture sheet_of(std::span<const TileRow> rows) {
  Size size{0, sheet_border};
  for (const TileRow& row : rows)
    size = {std::max(size.width, row_width(row)), size.height + row_height(row) + sheet_border};
  Picture sheet(size, ground);
  int y = sheet_border;
  for (const TileRow& row : rows) {
    int x = sheet_border;
    for (Tile tile : row) {
      paste(sheet, tile.picture, x, y);
      Picture caption({tile.picture.size.width, caption_room}, ground);  // Cuts a word that is too long.
      write(caption, 2, 16, fitted(tile.caption, caption.size.width - 2), caption_height);
      paste(sheet, caption, x, y + tile.picture.size.height);
      x += tile.picture.size.width + sheet_border;
    }
    y += row_height(row) + sheet_border;
  }
  return sheet;
}

void draw_label(Picture& picture, int x, int y, const std::string& text, int height) {
  const int width = int(0.65 * height * double(text.size())) + 4;
  const int left = std::clamp(x - width / 2, 0, std::max(0, picture.size.width - width));
  const int top = std::clamp(y - height / 2 - 2, 0, std::max(0, picture.size.height - height - 4));
  for (int j = top; j < std::min(top + height + 4, picture.size.height); ++j)
    for (int i = left; i < std::min(left + width, picture.size.width); ++i) picture.at(i, j) *= 0.3F;
  write(picture, left + 2, top + height, text, height);
}

void draw_ring(Picture& picture, double x, double y, double radius) {
  const int reach = int(radius) + 2, cx = int(x), cy = int(y);
  for (int j = cy - reach; j <= cy + reach; ++j)
    for (int i = cx - reach; i <= cx + reach; ++i) {
      const double outside = std::sqrt((i + 0.5 - x) * (i + 0.5 - x) + (j + 0.5 - y) * (j + 0.5 - y)) - radius;
      if (picture.holds(i, j) && std::abs(outside) < 1) picture.at(i, j) = Colour(outside > 0 ? 0.0F : 1.0F);
    }
}

}  // namespace tools
