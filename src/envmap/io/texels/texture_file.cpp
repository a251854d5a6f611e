#include "envmap/io/texels/texture_file.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <bit>
#include <cmath>

#include "envmap/base/error.h"
#include "envmap/base/parallel.h"
#include "envmap/io/block/bc6h.h"
#include "envmap/io/block/uastc_hdr.h"
#include "envmap/io/claims/srgb.h"
#include "envmap/io/images/bands.h"
#include "envmap/io/texels/api_orientation.h"

namespace envmap {
std::vector<std::byte> read_bytes(const InputFile& file, std::uint64_t offset, std::uint64_t size) {
  const std::uint64_t end = file.size();
  if (offset > end || size > end - offset)
    throw InputError(fmt::format("truncated or damaged: {} bytes at {} are beyond its end at {}", size, offset, end));
  std::vector<std::byte> bytes(size);
  if (file.pread(bytes.data(), size, offset) != size) throw InputError("cannot be read to its end");
  return bytes;
}

void check_texture(const TextureFile& t, std::uint64_t file_size) {
  constexpr int most = 1 << 20;
  if (t.width < 1 || t.height < 1)
    throw InputError(fmt::format("not an image or damaged: its size is {}x{}", t.width, t.height));
  if (t.width > most || t.height > most)
    throw InputError(fmt::format("its size of {}x{} is beyond {} a side", t.width, t.height, most));
  if (t.cube && t.width != t.height)
    throw InputError(fmt::format("damaged: cube faces of {}x{} are not square", t.width, t.height));
  if (t.levels < 1 || t.levels > int(std::bit_width(unsigned(std::max(t.width, t.height)))))
    throw InputError(fmt::format("damaged: {}x{} cannot have {} levels", t.width, t.height, t.levels));
  const double bytes = (t.cube ? 6.0 : 1.0) * t.width * t.height * sizeof(Colour);
  const double memory = double(::sysconf(_SC_PHYS_PAGES)) * double(::sysconf(_SC_PAGE_SIZE));
  // A header can promise anything. No map compresses to a 20,000th.
  if (bytes > 0x1p28 && bytes > 2e4 * double(file_size))
    throw InputError(fmt::format("truncated or damaged: {} bytes cannot hold {}x{}", file_size, t.width, t.height));
  if (bytes > memory)
    throw InputError(fmt::format("{}x{} needs {:.0f} GiB of memory; this machine has {:.0f}", t.width, t.height,
                                 bytes / 0x1p30, memory / 0x1p30));
}

void encode_rows(const TexelFormat& format, const Atlas& atlas, int begin, int end, std::span<const Colour> from,
                 std::vector<std::byte>& to) {
  const auto width = std::size_t(atlas.width());
  const std::size_t row_bytes = format.row_bytes(atlas.width());
  const int strips = int(format.blocks(end - begin));
  to.resize(std::size_t(strips) * row_bytes);
  parallel_for(strips, [&](int k) {
    const int top = begin + k * format.side, bottom = std::min(end, top + format.side);
    const auto rows = from.subspan(std::size_t(top - begin) * width, std::size_t(bottom - top) * width);
    const auto out = std::span(to).subspan(std::size_t(k) * row_bytes, row_bytes);
    if (format.depth == Depth::bc6h)
      encode_bc6h(rows, width, top == 0, bottom == atlas.height(), out);
    else if (format.depth == Depth::uastc_hdr)
      encode_uastc_hdr(rows, width, top == 0, bottom == atlas.height(), out);
    else
      encode(format.texels, rows, out);
  });
}

void encode_images(const TexelFormat& format, std::span<const Atlas> images, PartsOfProgress& shares,
                   const std::function<void(std::span<const std::byte> rows)>& write) {
  std::vector<std::byte> rows;
  for (const Atlas& image : images)
    for_each_band(image, shares.next(image), [&](int begin, int end, std::vector<Colour>& band) {
      encode_rows(format, image, begin, end, band, rows);
      write(rows);
    });
}

std::vector<Atlas> images_of(const Atlas& atlas, bool cube) {
  if (!cube) return {atlas};
  std::vector<Atlas> faces;
  for (int face = 0; face < 6; ++face) faces.push_back({atlas.rows, atlas.grid, face});
  return faces;
}

namespace {

using PutRow = std::function<void(int face, int row, std::span<const Colour> texels)>;

bool decode_row(const TextureFile& t, std::span<const std::byte> from, std::span<Colour> to) {
  if (t.packing.bytes == 0) return decode(t.texels, from, to);
  const bool opaque = decode(t.packing, from, to);
  if (t.texels == Texels::packed_srgb) decode_srgb(to);
  return opaque;
}

// All rows of the images of a level, from many threads at once. @return whether every alpha is 1.
bool decode_images(const TextureFile& t, std::span<const std::byte> bytes, int faces, int width, int height,
                   const PutRow& put) {
  const TexelFormat format = t.format();
  const std::size_t row_bytes = format.row_bytes(width), columns = std::size_t(width);
  const int strips = int(format.blocks(height));
  std::atomic<bool> opaque{true};
  parallel_for(faces * strips, [&](int k) {
    std::vector<Colour> rows(std::size_t(format.side) * columns);
    if (!decode_row(t, bytes.subspan(std::size_t(k) * row_bytes, row_bytes), rows)) opaque = false;
    const int top = k % strips * format.side;
    for (int j = 0; j < std::min(format.side, height - top); ++j)
      put(k / strips, top + j, std::span(rows).subspan(std::size_t(j) * columns, columns));
  });
  return opaque;
}

// What a file holds of a level, and what in it is the map.
struct Stored {
  std::span<const std::byte> bytes;
  int number;  // Of the level, in the file.
  const TextureFile& texture;
};

// @param opaque is set to whether every alpha is 1.
Level decode_cube(const Stored& s, bool& opaque) {
  const int size = s.texture.level_height(s.number);
  Level cube(Projection::cube, size);
  opaque = decode_images(s.texture, s.bytes, 6, size, size, [&](int face, int row, std::span<const Colour> texels) {
    const auto out = cube.row(face, is_y_face(face) ? size - 1 - row : row);
    std::ranges::copy(texels, out.begin());
    if (!is_y_face(face)) std::ranges::reverse(out);
  });
  return cube;
}

// @param number the level of `base` that it is.
Level decode_flat(const Stored& s, const DetectedLayout& base, int number, bool& opaque) {
  const int w = s.texture.level_width(s.number), h = s.texture.level_height(s.number);
  std::vector<Colour> image(std::size_t(w) * std::size_t(h));
  opaque = decode_images(s.texture, s.bytes, 1, w, h, [&](int, int row, std::span<const Colour> texels) {
    const auto to = std::ptrdiff_t(s.texture.bottom_up ? h - 1 - row : row) * w;
    std::ranges::copy(texels, image.begin() + to);
  });
  const FaceSize face = face_size(base, number);
  const Grid places = grid(base.layout);
  if (w < places.columns * face.width || h < places.rows * face.height)
    throw InputError(
        fmt::format("level {} is {}x{}, too small for faces of {}x{}", number, w, h, face.width, face.height));
  Level flat(base.projection, face.height, face.width);
  scatter(image, w, 0, h, places, flat);
  return flat;
}

}  // namespace

Level read_texture(const InputFile& file, const TextureFile& t, int stored, const DetectedLayout& base, int number,
                   bool any_alpha, bool encoded) {
  const std::vector<std::byte> bytes = t.bytes(file, stored);
  if (const int h = t.level_height(stored); t.cube && h != face_size(base, number).height)
    throw InputError(fmt::format("is {0}x{0}, not level {1} of {2}x{2}", h, number, base.size));
  bool opaque = true;
  Level level =
      t.cube ? decode_cube({bytes, stored, t}, opaque) : decode_flat({bytes, stored, t}, base, number, opaque);
  if (!opaque && !any_alpha) throw InputError("has an alpha that is not 1 everywhere", Remedy::drop_channels);
  if (encoded)
    for_each_row(level.faces(), level.height(), {}, [&](int face, int row) { decode_srgb(level.row(face, row)); });
  return level;
}

namespace {

// The channels of two readings that lie farther off.
Level farther_off(const Level& truth, Level a, const Level& b) {
  for_each_row(a.faces(), a.height(), {}, [&](int face, int row) {
    const auto wanted = truth.row(face, row), other = b.row(face, row);
    const auto made = a.row(face, row);
    for (std::size_t k = 0; k < made.size(); ++k)
      for (int c = 0; c < 3; ++c)
        if (std::abs(other[k][c] - wanted[k][c]) > std::abs(made[k][c] - wanted[k][c])) made[k][c] = other[k][c];
  });
  return a;
}

}  // namespace

Level read_back(const Level& level, Texels texels) {
  const bool cube = level.projection() == Projection::cube;
  const Rows rows = rows_of(level, Forward::plus_z), stored = cube ? in_api_orientation(rows) : rows;
  const Layout layout = cube ? Layout::api : default_layout(level.projection());
  std::vector<std::byte> bytes, packed;
  int width = 0, height = 0;
  for (const Atlas& image : images_of({stored, grid(layout)}, cube)) {
    width = image.width(), height = image.height();
    std::vector<Colour> all(std::size_t(width) * std::size_t(height));
    image.gather(0, height, all);
    encode_rows(format_of(texels), image, 0, height, all, packed);
    bytes.insert(bytes.end(), packed.begin(), packed.end());
  }
  const auto read_as = [&](Texels kind) {
    const TextureFile texture{.container = "", .texels = kind, .width = width, .height = height, .cube = cube};
    bool opaque = true;
    return cube ? decode_cube({bytes, 0, texture}, opaque)
                : decode_flat({bytes, 0, texture}, {level.projection(), layout, level.height()}, 0, opaque);
  };
  Level read = read_as(texels);
  if (texels != Texels::uastc_hdr) return read;
  transcode_to_bc6h(bytes);
  return farther_off(level, std::move(read), read_as(Texels::bc6h_ufloat));
}

}  // namespace envmap
