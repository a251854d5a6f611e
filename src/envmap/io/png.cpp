#include "envmap/io/png.h"

#include <fmt/format.h>
#include <png.h>

#include "envmap/base/error.h"

namespace envmap {
namespace {

// libpng's simplified interface ("png_image", libpng-manual.txt, section V).
struct Image : png_image {
  Image() : png_image{} { version = PNG_IMAGE_VERSION; }
  ~Image() { png_image_free(this); }
  Image(const Image&) = delete;
};

void begin(Image& image, std::span<const std::byte> png) {
  if (!png_image_begin_read_from_memory(&image, png.data(), png.size()))
    throw InputError(fmt::format("damaged: a face is no PNG image: {}", image.message));
  // A header can promise anything; deflate makes nothing smaller than a 1032nd.
  const double bytes = double(PNG_IMAGE_SIZE(image));
  if (image.width > 1 << 16 || image.height > 1 << 16 || bytes > 4 * 1032.0 * double(png.size()))
    throw InputError(
        fmt::format("damaged: {} bytes cannot hold a face of {}x{}", png.size(), image.width, image.height));
}

}  // namespace

std::vector<char> png_of_rgba(std::span<const std::byte> rgba, int width, int height) {
  Image image;
  image.width = static_cast<png_uint_32>(width);
  image.height = static_cast<png_uint_32>(height);
  image.format = PNG_FORMAT_RGBA;
  std::vector<char> file(PNG_IMAGE_PNG_SIZE_MAX(image));
  png_alloc_size_t size = file.size();
  if (!png_image_write_to_memory(&image, file.data(), &size, 0, rgba.data(), 0, nullptr))
    throw OutputError(fmt::format("not written as PNG: {}", image.message));
  file.resize(size);
  return file;
}

Size size_of_png(std::span<const std::byte> png) {
  Image image;
  begin(image, png);
  return {int(image.width), int(image.height)};
}

RgbaImage rgba_of_png(std::span<const std::byte> png) {
  Image image;
  begin(image, png);
  image.format = PNG_FORMAT_RGBA;
  RgbaImage out{int(image.width), int(image.height), std::vector<std::byte>(PNG_IMAGE_SIZE(image))};
  if (!png_image_finish_read(&image, nullptr, out.bytes.data(), 0, nullptr))
    throw InputError(fmt::format("damaged: a face does not decompress: {}", image.message));
  return out;
}

}  // namespace envmap
