#include "envmap/io/texels/texels.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <vector>

#include "envmap/io/block/bc6h.h"
#include "envmap/io/block/uastc_hdr.h"
#include "envmap/io/claims/srgb.h"
#include "envmap/io/texels/rgbd.h"

namespace envmap {

// Without branches, so that the compiler vectorises it (IEEE 754, binary32 to binary16). Small values: a sum with 0.5
// leaves the subnormal half in the lowest bits, rounded. Others:
// the exponent is biased anew and the mantissa rounded by a carry.
void to_half(std::span<const float> from, std::span<std::uint16_t> to) {
  for (std::size_t i = 0; i < from.size(); ++i) {
    const auto bits = std::bit_cast<std::uint32_t>(from[i]);
    const std::uint32_t sign = bits >> 16 & 0x8000, x = bits & 0x7fffffff;
    const std::uint32_t small = std::bit_cast<std::uint32_t>(std::bit_cast<float>(x) + 0.5F) - 0x3f000000;
    const std::uint32_t normal = (x - 0x38000000 + 0xfff + (x >> 13 & 1)) >> 13;
    const std::uint32_t large = x > 0x7f800000 ? 0x7e00 : 0x7c00;
    const std::uint32_t half = x < 0x38800000 ? small : x < 0x477ff000 ? normal : large;
    to[i] = std::uint16_t(sign | half);
  }
}

// The half's bits as a float are the value x 2^-112, subnormals too.
void from_half(std::span<const std::uint16_t> from, std::span<float> to) {
  for (std::size_t i = 0; i < from.size(); ++i) {
    const std::uint32_t sign = std::uint32_t{from[i]} << 16 & 0x80000000, x = std::uint32_t{from[i]} << 13 & 0x0fffe000;
    const auto finite = std::bit_cast<std::uint32_t>(std::bit_cast<float>(x) * 0x1p112F);
    to[i] = std::bit_cast<float>(sign | (x < 0x0f800000 ? finite : x | 0x70000000));
  }
}

namespace {

static_assert(std::endian::native == std::endian::little, "KTX and DDS files are little-endian, and so is this code");

std::uint32_t to_rgb9e5(const Colour& c) {
  const float most = std::max({c.x, c.y, c.z});
  if (most == 0) return 0;
  int exponent = 0;
  std::frexp(most, &exponent);  // most < 2^exponent.
  exponent = std::max(exponent, -15);
  if (std::lround(std::ldexp(most, 9 - exponent)) == 512) ++exponent;
  const auto mantissa = [&](float x) { return std::uint32_t(std::lround(std::ldexp(x, 9 - exponent))); };
  return mantissa(c.x) | mantissa(c.y) << 9 | mantissa(c.z) << 18 | std::uint32_t(exponent + 15) << 27;
}

Colour from_rgb9e5(std::uint32_t word) {
  const float step = std::ldexp(1.0F, int(word >> 27) - 24);
  return step * Colour(float(word & 511), float(word >> 9 & 511), float(word >> 18 & 511));
}

// A float without sign, 5 bits of exponent and `bits` of mantissa: as half, but shorter.
float small_float(std::uint32_t word, int bits) {
  const std::uint32_t exponent = word >> bits & 31, mantissa = word & ((1U << bits) - 1);
  if (exponent == 31)
    return mantissa ? std::numeric_limits<float>::quiet_NaN() : std::numeric_limits<float>::infinity();
  const std::uint32_t whole = exponent ? mantissa | 1U << bits : mantissa;
  return std::ldexp(float(whole), std::max(1, int(exponent)) - 15 - bits);
}

// Floats with one, three or four channels.
bool colours(std::span<const float> values, std::size_t channels, std::span<Colour> to) {
  bool opaque = true;
  for (std::size_t i = 0; i < to.size(); ++i) {
    const float* v = values.data() + i * channels;
    to[i] = channels == 1 ? Colour(v[0]) : Colour(v[0], v[1], v[2]);
    if (channels == 4) opaque = opaque && v[3] == 1;
  }
  return opaque;
}

}  // namespace

void encode(Texels texels, std::span<const Colour> from, std::span<std::byte> to) {
  if (texels == Texels::rgbd8) return encode_rgbd(from, to);
  if (texels == Texels::rgb9e5) {
    for (std::size_t i = 0; i < from.size(); ++i) {
      const std::uint32_t word = to_rgb9e5(from[i]);
      std::memcpy(to.data() + 4 * i, &word, 4);
    }
    return;
  }
  const TexelFormat& format = format_of(texels);
  std::vector<float> values;
  values.reserve(4 * from.size());
  for (const Colour& c : from) {
    values.insert(values.end(), {c.x, c.y, c.z});
    if (format.channels == 4) values.push_back(1);
  }
  if (format.depth == Depth::single)
    std::memcpy(to.data(), values.data(), to.size());
  else
    to_half(values, {reinterpret_cast<std::uint16_t*>(to.data()), values.size()});
}

bool decode(Texels texels, std::span<const std::byte> from, std::span<Colour> to) {
  const TexelFormat& format = format_of(texels);
  if (format.depth == Depth::bc6h) {
    decode_bc6h(from, texels == Texels::bc6h_sfloat, to.size() / std::size_t(format.side), to);
    return true;
  }
  if (texels == Texels::uastc_hdr) {
    decode_uastc_hdr(from, to.size() / std::size_t(format.side), to);
    return true;
  }
  if (texels == Texels::rgbd8) {
    decode_rgbd(from, to);
    return true;
  }
  if (texels == Texels::rgb9e5 || texels == Texels::rg11b10f) {
    for (std::size_t i = 0; i < to.size(); ++i) {
      std::uint32_t word = 0;
      std::memcpy(&word, from.data() + 4 * i, 4);
      to[i] = texels == Texels::rgb9e5
                  ? from_rgb9e5(word)
                  : Colour(small_float(word & 2047, 6), small_float(word >> 11 & 2047, 6), small_float(word >> 22, 5));
    }
    return true;
  }
  const auto channels = std::size_t(format.channels);
  std::vector<float> values(channels * to.size());
  if (format.depth == Depth::uint8) {
    std::ranges::transform(from, values.begin(), [](std::byte b) { return float(b) / 255; });
    const bool opaque = colours(values, channels, to);
    if (texels == Texels::rgb8_srgb || texels == Texels::rgba8_srgb) decode_srgb(to);
    return opaque;
  }
  if (format.depth == Depth::single)
    std::memcpy(values.data(), from.data(), values.size() * sizeof(float));
  else
    from_half({reinterpret_cast<const std::uint16_t*>(from.data()), values.size()}, values);
  return colours(values, channels, to);
}

bool decode(const Packing& packing, std::span<const std::byte> from, std::span<Colour> to) {
  const auto value = [](std::uint64_t word, std::uint64_t mask) {
    const int shift = std::countr_zero(mask);
    return float(double((word & mask) >> shift) / double(mask >> shift));
  };
  bool opaque = true;
  for (std::size_t i = 0; i < to.size(); ++i) {
    std::uint64_t word = 0;
    std::memcpy(&word, from.data() + i * std::size_t(packing.bytes), std::size_t(packing.bytes));
    const float red = value(word, packing.red);
    to[i] = packing.green == 0 ? Colour(red) : Colour(red, value(word, packing.green), value(word, packing.blue));
    opaque = opaque && (word & packing.alpha) == packing.alpha;
  }
  return opaque;
}

}  // namespace envmap
