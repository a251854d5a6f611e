#include "envmap/io/images/exif_orientation.h"

#include <fmt/format.h>

#include <algorithm>
#include <memory>

#include "envmap/base/parallel.h"

namespace envmap {

std::pair<int, int> place_in_file(Orientation o, int width, int height, int x, int y) {
  switch (o) {
    case Orientation::upright: return {x, y};
    case Orientation::top_right: return {width - 1 - x, y};
    case Orientation::bottom_right: return {width - 1 - x, height - 1 - y};
    case Orientation::bottom_left: return {x, height - 1 - y};
    case Orientation::left_top: return {y, x};
    case Orientation::right_top: return {y, width - 1 - x};
    case Orientation::right_bottom: return {height - 1 - y, width - 1 - x};
    case Orientation::left_bottom: return {height - 1 - y, x};
  }
  return {x, y};
}

namespace {

// The channels that were asked for last, as the file has them.
struct Whole {
  int first = -1, count = 0;
  std::vector<float> values = {};
};

}  // namespace

ImageReader turned_upright(ImageReader stored) {
  const Orientation orientation = stored.facts.orientation;
  ImageReader upright{.format = stored.format, .facts = stored.facts};
  if (is_transposed(orientation)) std::swap(upright.facts.width, upright.facts.height);
  upright.facts.orientation = Orientation::upright;
  constexpr const char* first_row[] = {"top", "top", "bottom", "bottom", "left", "right", "right", "left"};
  constexpr const char* first_column[] = {"left", "right", "right", "left", "top", "top", "bottom", "bottom"};
  const std::size_t number = std::size_t(orientation) - 1;
  upright.facts.claims.push_back(
      {"orientation", fmt::format("first row {}, first column {}", first_row[number], first_column[number])});
  upright.facts.details.emplace_back("turned upright");
  upright.facts.tile_width = upright.facts.tile_height = 0;
  const auto whole = std::make_shared<Whole>();
  upright.read = [stored = std::move(stored), facts = upright.facts, orientation,
                  whole](int, int begin, int end, int first, int count, std::span<float> out) {
    const auto channels = std::size_t(count);
    if (whole->first != first || whole->count != count) {
      const int rows = stored.facts.height;
      whole->values.resize(std::size_t(stored.facts.width) * std::size_t(rows) * channels);
      stored.read(0, 0, rows, first, count, whole->values);
      whole->first = first, whole->count = count;
    }
    float* to = out.data();
    for (int y = begin; y < end; ++y)
      for (int x = 0; x < facts.width; ++x) {
        const auto [column, row] = place_in_file(orientation, facts.width, facts.height, x, y);
        const std::size_t at = std::size_t(row) * std::size_t(stored.facts.width) + std::size_t(column);
        for (std::size_t c = 0; c < channels; ++c) *to++ = whole->values[at * channels + c];
      }
  };
  return upright;
}

Rows stored_rows(const Rows& rows, int face, Orientation o) {
  const int n = rows.size;
  Rows stored = rows;
  if (!is_transposed(o)) {
    const auto [column, row] = place_in_file(o, n, n, 0, 0);
    stored.fill = [rows, n, mirrored = column > 0, from_below = row > 0](int f, int y, std::span<Colour> out) {
      rows.fill(f, from_below ? n - 1 - y : y, out);
      if (mirrored) std::ranges::reverse(out);
    };
    return stored;
  }
  const auto image = std::make_shared<std::vector<Colour>>(std::size_t(n) * std::size_t(n));
  parallel_for(n, [&](int y) {
    std::vector<Colour> line(std::size_t(n), Colour(0));
    rows.fill(face, y, line);
    for (int x = 0; x < n; ++x) {
      const auto [column, row] = place_in_file(o, n, n, x, y);
      (*image)[std::size_t(row) * std::size_t(n) + std::size_t(column)] = line[std::size_t(x)];
    }
  });
  stored.fill = [image, n](int, int y, std::span<Colour> out) {
    std::copy_n(image->begin() + std::ptrdiff_t(y) * n, n, out.begin());
  };
  return stored;
}

void copy_upright(const Level& stored, int stored_face, Orientation o, Level& map, int face) {
  const int n = map.height();
  parallel_for(n, [&](int y) {
    const auto to = map.row(face, y);
    for (int x = 0; x < n; ++x) {
      const auto [column, row] = place_in_file(o, n, n, x, y);
      to[std::size_t(x)] = stored.row(stored_face, row)[std::size_t(column)];
    }
  });
}

}  // namespace envmap
