#include "envmap/io/texels/rgbd.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "envmap/base/error.h"
#include "envmap/io/formats/jpeg.h"
#include "envmap/io/formats/png.h"
#include "envmap/io/images/bands.h"
#include "envmap/maths/portable.h"

namespace envmap {
namespace {

// What the bytes of a colour mean before they are divided.
const std::array<float, 256>& linear_of_byte() {
  static const auto table = [] {
    std::array<float, 256> t;
    for (int k = 0; k < 256; ++k) t[std::size_t(k)] = float(portable::pow(k / 255.0, 2.2));
    return t;
  }();
  return table;
}

// The byte whose meaning is nearest.
std::byte nearest_byte(float value) {
  const auto& table = linear_of_byte();
  auto above = std::ranges::lower_bound(table, value);
  if (above == table.end()) return std::byte{255};
  if (above != table.begin() && value - above[-1] < *above - value) --above;
  return static_cast<std::byte>(above - table.begin());
}

// The face whose image stands for another: that across X, which is negated.
std::size_t placed(std::size_t face) { return face < 2 ? 1 - face : face; }

// Upside down and, X being negated, every row reversed: from the image of a face to that of a file, and back.
void turn(std::span<std::byte> image, int size) {
  const std::size_t row = 4 * std::size_t(size);
  for (int j = 0; j < size / 2; ++j)
    std::ranges::swap_ranges(image.subspan(std::size_t(j) * row, row),
                             image.subspan(std::size_t(size - 1 - j) * row, row));
  for (std::size_t at = 0; at < image.size(); at += row)
    for (std::size_t i = 0; i < row / 2; i += 4)
      std::swap_ranges(image.begin() + std::ptrdiff_t(at + i), image.begin() + std::ptrdiff_t(at + i + 4),
                       image.begin() + std::ptrdiff_t(at + row - 4 - i));
}

}  // namespace

void encode_rgbd(std::span<const Colour> from, std::span<std::byte> to) {
  for (std::size_t i = 0; i < from.size(); ++i) {
    const Colour& c = from[i];
    const float most = std::max({c.x, c.y, c.z, 1.0F}), alpha = std::max(1.0F, std::floor(255 / most));
    for (int k = 0; k < 3; ++k) to[4 * i + std::size_t(k)] = nearest_byte(c[k] * alpha / 255);
    to[4 * i + 3] = static_cast<std::byte>(alpha);
  }
}

void decode_rgbd(std::span<const std::byte> from, std::span<Colour> to) {
  const auto& table = linear_of_byte();
  const auto value = [&](std::size_t at) { return table[std::to_integer<std::size_t>(from[at])]; };
  for (std::size_t i = 0; i < to.size(); ++i) {
    const int alpha = std::to_integer<int>(from[4 * i + 3]);
    const float scale = alpha == 0 ? 0 : 255 / float(alpha);
    to[i] = scale * Colour(value(4 * i), value(4 * i + 1), value(4 * i + 2));
  }
}

std::vector<RgbdFaces> rgbd_faces(std::span<const Atlas> levels, const Progress& progress) {
  PartsOfProgress shares(progress, levels);
  std::vector<RgbdFaces> files;
  for (const Atlas& atlas : levels) {
    const std::vector<Atlas> images = images_of(atlas, true);
    RgbdFaces& faces = files.emplace_back();
    const int size = images[0].width();
    const std::size_t texels = std::size_t(size) * std::size_t(size);
    for (std::size_t face = 0; face < faces.size(); ++face) {
      std::vector<Colour> colours(texels);
      std::vector<std::byte> bytes(4 * texels);
      images[placed(face)].gather(0, size, colours);
      encode_rgbd(colours, bytes);
      turn(bytes, size);
      faces[face] = png_of_rgba(bytes, size, size);
      if (const Progress part = shares.next(images[face])) part(1);
    }
  }
  return files;
}

namespace {

bool is_jpeg(std::span<const std::byte> file) {
  return file.size() > 1 && file[0] == std::byte{0xff} && file[1] == std::byte{0xd8};
}

// Without its alpha, which is 255.
RgbaImage rgba_of_jpeg(std::span<const std::byte> bytes) {
  const InputFile file(std::span(reinterpret_cast<const char*>(bytes.data()), bytes.size()));
  const std::optional<ImageReader> reader = open_jpeg(file, std::nullopt, true);
  if (!reader) throw InputError("not supported: a face is a JPEG image with an orientation, a gain map or inks");
  const int width = reader->facts.width, height = reader->facts.height;
  const auto channels = reader->facts.channels.size();
  const std::size_t texels = std::size_t(width) * std::size_t(height);
  if (double(texels) > 1e4 * double(bytes.size()))
    throw InputError(fmt::format("damaged: {} bytes cannot hold a face of {}x{}", bytes.size(), width, height));
  std::vector<float> values(texels * channels);
  reader->read(0, 0, height, 0, int(channels), values);
  RgbaImage image{width, height, std::vector<std::byte>(4 * texels, std::byte{255})};
  for (std::size_t k = 0; k < texels; ++k)
    for (std::size_t c = 0; c < 3; ++c)
      image.bytes[4 * k + c] = static_cast<std::byte>(std::lround(255 * values[k * channels + c % channels]));
  return image;
}

RgbaImage rgba_of(std::span<const std::byte> file) { return is_jpeg(file) ? rgba_of_jpeg(file) : rgba_of_png(file); }

Size size_of(std::span<const std::byte> file) {
  if (!is_jpeg(file)) return size_of_png(file);
  const RgbaImage image = rgba_of_jpeg(file);
  return {image.width, image.height};
}

}  // namespace

TextureFile rgbd_texture(const InputFile& file, const char* container, std::size_t images, const FaceImage& image,
                         std::uint64_t size) {
  if (images == 0 || images % 6 != 0)
    throw InputError(fmt::format("damaged: {} images are no six faces a level", images));
  const Size first = size_of(image(file, 0));
  TextureFile t{.container = container,
                .texels = Texels::rgbd8,
                .width = first.width,
                .height = first.height,
                .levels = int(std::min<std::size_t>(images / 6, 64)),
                .cube = true};
  check_texture(t, size);
  t.bytes = [t, image](const InputFile& from, int level) {
    const std::uint64_t all = t.image_bytes(level);
    std::vector<std::byte> bytes;
    for (std::size_t face = 0; face < 6; ++face) {
      RgbaImage found = rgba_of(image(from, 6 * std::size_t(level) + placed(face)));
      if (found.bytes.size() != all || found.width != t.level_width(level))
        throw InputError(fmt::format("damaged: a face of level {} is {}x{}", level, found.width, found.height));
      turn(found.bytes, found.width);
      bytes.insert(bytes.end(), found.bytes.begin(), found.bytes.end());
    }
    return bytes;
  };
  return t;
}

}  // namespace envmap
