#include "envmap/io/half.h"

#include <bit>

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

}  // namespace envmap
