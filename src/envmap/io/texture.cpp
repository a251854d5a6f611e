#include "envmap/io/texture.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <bit>

#include "envmap/base/error.h"
#include "envmap/map/page.h"

namespace envmap {
namespace {

bool is_y_face(int face) { return face == 2 || face == 3; }

}  // namespace

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
  if (t.width < 1 || t.height < 1 || t.width > most || t.height > most)
    throw InputError(fmt::format("not a flat image: {}x{}", t.width, t.height));
  if (t.cube && t.width != t.height)
    throw InputError(fmt::format("damaged: cube faces of {}x{} are not square", t.width, t.height));
  if (t.levels < 1 || t.levels > static_cast<int>(std::bit_width(static_cast<unsigned>(std::max(t.width, t.height)))))
    throw InputError(fmt::format("damaged: {}x{} cannot have {} levels", t.width, t.height, t.levels));
  const double bytes = (t.cube ? 6.0 : 1.0) * t.width * t.height * sizeof(Colour);
  const double memory = static_cast<double>(::sysconf(_SC_PHYS_PAGES)) * static_cast<double>(::sysconf(_SC_PAGE_SIZE));
  // A header can promise anything. No map compresses to a 20,000th.
  if (bytes > 0x1p28 && bytes > 2e4 * static_cast<double>(file_size))
    throw InputError(fmt::format("truncated or damaged: {} bytes cannot hold {}x{}", file_size, t.width, t.height));
  if (bytes > memory)
    throw InputError(fmt::format("{}x{} needs {:.0f} GiB of memory; this machine has {:.0f}", t.width, t.height,
                                 bytes / 0x1p30, memory / 0x1p30));
}

void encode_rows(const TexelFormat& format, std::span<const Colour> from, std::size_t width, std::vector<std::byte>& to) {
  const auto bytes = static_cast<std::size_t>(format.bytes) * width;
  to.resize(from.size() / width * bytes);
  tbb::parallel_for(std::size_t{0}, from.size() / width, [&](std::size_t row) {
    encode(format.texels, from.subspan(row * width, width), std::span(to).subspan(row * bytes, bytes));
  });
}

Rows in_api_orientation(const Rows& rows) {
  Rows turned = rows;
  turned.fill = [rows](int face, int row, std::span<Colour> out) {
    rows.fill(face, is_y_face(face) ? rows.size - 1 - row : row, out);
    if (!is_y_face(face)) std::ranges::reverse(out);
  };
  return turned;
}

namespace {

using PutRow = std::function<void(int face, int row, std::span<const Colour> texels)>;

// All rows of the images of a level, from many threads at once. @return whether every alpha is 1.
bool decode_images(const TexelFormat& format, std::span<const std::byte> bytes, int faces, int width, int height,
                   const PutRow& put) {
  const std::size_t row_bytes = format.row_bytes(width), columns = static_cast<std::size_t>(width);
  const int strips = static_cast<int>(format.blocks(height));
  std::atomic<bool> opaque{true};
  tbb::parallel_for(0, faces * strips, [&](int k) {
    std::vector<Colour> rows(static_cast<std::size_t>(format.side) * columns);
    if (!decode(format.texels, bytes.subspan(static_cast<std::size_t>(k) * row_bytes, row_bytes), rows)) opaque = false;
    const int top = k % strips * format.side;
    for (int j = 0; j < std::min(format.side, height - top); ++j)
      put(k / strips, top + j, std::span(rows).subspan(static_cast<std::size_t>(j) * columns, columns));
  });
  return opaque;
}

}  // namespace

Level read_texture(const InputFile& file, const TextureFile& t, int stored, const Recognised& base, int number,
                   bool any_alpha) {
  const std::vector<std::byte> bytes = t.bytes(file, stored);
  const TexelFormat& format = format_of(t.texels);
  const int w = t.level_width(stored), h = t.level_height(stored);
  bool opaque = true;
  Level level = [&] {
    if (t.cube) {
      if (h != face_size(base, number).height)
        throw InputError(fmt::format("is {0}x{0}, not level {1} of {2}x{2}", h, number, base.size));
      Level cube(Projection::cube, h);
      opaque = decode_images(format, bytes, 6, w, h, [&](int face, int row, std::span<const Colour> texels) {
        const auto out = cube.row(face, is_y_face(face) ? h - 1 - row : row);
        std::ranges::copy(texels, out.begin());
        if (!is_y_face(face)) std::ranges::reverse(out);
      });
      return cube;
    }
    std::vector<Colour> image(static_cast<std::size_t>(w) * static_cast<std::size_t>(h));
    opaque = decode_images(format, bytes, 1, w, h, [&](int, int row, std::span<const Colour> texels) {
      const auto to = static_cast<std::ptrdiff_t>(t.bottom_up ? h - 1 - row : row) * w;
      std::ranges::copy(texels, image.begin() + to);
    });
    const FaceSize face = face_size(base, number);
    const Grid places = grid(base.layout);
    if (w < places.columns * face.width || h < places.rows * face.height)
      throw InputError(fmt::format("level {} is {}x{}, too small for faces of {}x{}", number, w, h, face.width, face.height));
    Level flat(base.projection, face.height, face.width);
    scatter(image, w, 0, h, places, flat);
    return flat;
  }();
  if (!opaque && !any_alpha)
    throw InputError("has an alpha that is not 1 everywhere", Remedy::drop_channels);
  return level;
}

}  // namespace envmap
