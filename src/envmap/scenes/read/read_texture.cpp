#include "envmap/scenes/read/read_texture.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "envmap/base/error.h"
#include "envmap/io/images/open_image.h"
#include "envmap/scenes/scene/mesh.h"

namespace envmap {
namespace {

struct Pixels {
  int width, height, channels;
  bool encoded;  // By the sRGB curve.
  std::vector<float> values;
};

Pixels read_pixels(const std::string& name, std::vector<char> bytes, std::uint64_t& pixels_left) {
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
  Pixels pixels{facts.width, facts.height, channels, facts.encoded, std::vector<float>(count * std::size_t(channels))};
  image.read(0, 0, facts.height, 0, channels, pixels.values);
  return pixels;
}

Texture rounded(const Pixels& p) {
  Texture texture{.width = p.width,
                  .height = p.height,
                  .texels = std::vector<glm::u8vec4>(p.values.size() / std::size_t(p.channels))};
  for (std::size_t k = 0; k < texture.texels.size(); ++k) {
    const auto v = [&](int c) {
      const float value = p.values[k * std::size_t(p.channels) + std::size_t(c)];
      return static_cast<unsigned char>(std::lround(255 * (value > 0 ? std::min(value, 1.0F) : 0)));
    };
    const bool grey = p.channels < 3;
    texture.texels[k] = {v(0), v(grey ? 0 : 1), v(grey ? 0 : 2), p.channels % 2 == 0 ? v(p.channels - 1) : 255};
  }
  return texture;
}

// IEC 61966-2-1.
float encoded(float linear) {
  return linear <= 0.0031308F ? 12.92F * linear : 1.055F * std::pow(linear, 1 / 2.4F) - 0.055F;
}

}  // namespace

Texture decode_texture(const std::string& name, std::vector<char> bytes, std::uint64_t& pixels_left) {
  return rounded(read_pixels(name, std::move(bytes), pixels_left));
}

Texture decode_colours(const std::string& name, std::vector<char> bytes, std::uint64_t& pixels_left,
                       std::vector<std::string>& unsupported) {
  Pixels pixels = read_pixels(name, std::move(bytes), pixels_left);
  if (pixels.encoded) return rounded(pixels);
  const std::size_t channels = std::size_t(pixels.channels), colours = channels < 3 ? 1 : 3;
  bool is_clipped = false;
  for (std::size_t k = 0; k < pixels.values.size(); ++k) {
    if (k % channels >= colours) continue;  // Alpha.
    is_clipped |= pixels.values[k] > 1;
    pixels.values[k] = encoded(pixels.values[k]);
  }
  if (is_clipped) note_once(unsupported, "colours of textures above 1");
  return rounded(pixels);
}

}  // namespace envmap
