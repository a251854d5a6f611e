#include "envmap/scene/read/read_texture.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "envmap/base/error.h"
#include "envmap/io/image.h"

namespace envmap {

Texture decode_texture(const std::string& name, std::vector<char> bytes, std::uint64_t& pixels_left) {
  Image image;
  // Alpha is coverage, and colours are not multiplied by it (glTF 2.0, section 3.9.4).
  open_bytes(image, name, std::move(bytes), true);
  if (!image.reader) image.fail("is no picture");
  const ImageFacts& facts = image.reader->facts;
  constexpr int most = 16384;
  if (facts.width < 1 || facts.height < 1 || !facts.flat || facts.width > most || facts.height > most)
    image.fail(fmt::format("is {}x{}; textures have 1 to {} texels a side", facts.width, facts.height, most));
  // No picture is compressed by more: the header promises what the file cannot hold.
  const double texels = double(facts.width) * facts.height;
  if (texels > 0x1p24 && texels > 5e3 * double(image.size))
    image.fail(fmt::format("truncated or damaged: {} bytes cannot hold {}x{}", image.size, facts.width, facts.height));
  const int channels = std::min(int(facts.channels.size()), 4);
  const auto count = std::size_t(facts.width) * std::size_t(facts.height);
  if (count > pixels_left)
    image.fail(fmt::format("{}x{}: with it the scene's textures have too many pixels", facts.width, facts.height),
               Remedy::allow_pixels);
  pixels_left -= count;
  std::vector<float> values(count * std::size_t(channels));
  image.read(0, 0, facts.height, 0, channels, values);
  Texture texture{.width = facts.width, .height = facts.height, .texels = std::vector<glm::u8vec4>(count)};
  for (std::size_t k = 0; k < count; ++k) {
    const auto v = [&](int c) {
      const float value = values[k * std::size_t(channels) + std::size_t(c)];
      return static_cast<unsigned char>(std::lround(255 * std::clamp(value, 0.0F, 1.0F)));
    };
    const bool grey = channels < 3;
    texture.texels[k] = {v(0), v(grey ? 0 : 1), v(grey ? 0 : 2), channels % 2 == 0 ? v(channels - 1) : 255};
  }
  return texture;
}

}  // namespace envmap
