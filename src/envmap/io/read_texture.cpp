#include "envmap/io/read_texture.h"

#include <fmt/format.h>

#include <filesystem>
#include <fstream>
#include <iterator>

#include "envmap/io/image.h"

namespace envmap {

Texture decode_texture(const std::string& name, std::vector<char> bytes) {
  Image image;
  // Alpha is coverage, and colours are not multiplied by it (glTF 2.0, section 3.9.4).
  OIIO::ImageSpec config;
  config.attribute("oiio:UnassociatedAlpha", 1);
  open_bytes(image, name, std::move(bytes), config);
  if (!image.input) image.fail("is no picture");
  const OIIO::ImageSpec& spec = image.input->spec();
  constexpr int most = 16384;
  if (spec.width < 1 || spec.height < 1 || spec.depth > 1 || spec.width > most || spec.height > most)
    image.fail(fmt::format("is {}x{}; textures have 1 to {} texels a side", spec.width, spec.height, most));
  // No picture is compressed by more: the header promises what the file cannot hold.
  const double texels = static_cast<double>(spec.width) * spec.height;
  if (texels > 0x1p24 && texels > 5e3 * static_cast<double>(image.size))
    image.fail(fmt::format("truncated or damaged: {} bytes cannot hold {}x{}", image.size, spec.width, spec.height));
  const int channels = std::min(spec.nchannels, 4);
  const auto count = static_cast<std::size_t>(spec.width) * static_cast<std::size_t>(spec.height);
  std::vector<unsigned char> values(count * static_cast<std::size_t>(channels));
  const SilentLibraries silent(true);
  if (!image.input->read_image(0, 0, 0, channels, OIIO::TypeDesc::UINT8, values.data()) || image.input->has_error())
    image.fail("truncated or damaged: " + first_line(image.input->geterror()));
  Texture texture{.width = spec.width, .height = spec.height, .texels = std::vector<glm::u8vec4>(count)};
  for (std::size_t k = 0; k < count; ++k) {
    const unsigned char* v = &values[k * static_cast<std::size_t>(channels)];
    const bool grey = channels < 3;
    texture.texels[k] = {v[0], v[grey ? 0 : 1], v[grey ? 0 : 2], channels % 2 == 0 ? v[channels - 1] : 255};
  }
  return texture;
}

Texture read_texture_file(const std::string& path) {
  Image image;
  image.name = path;
  std::error_code error;
  if (!std::filesystem::is_regular_file(path, error)) image.fail("no such file");
  std::ifstream stream(path, std::ios::binary);
  return decode_texture(path, {std::istreambuf_iterator<char>(stream), {}});
}

}  // namespace envmap
