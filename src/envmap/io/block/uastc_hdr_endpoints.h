/// @file
/// End points of UASTC HDR: the two of ASTC's colour endpoint modes that it takes, as bytes and as 12 bits of ASTC's
/// logarithm a channel. Source: Khronos, "Data Format Specification" 1.4, "ASTC compressed texture image formats", HDR
/// endpoint modes 7 and 11.
#pragma once

#include <array>
#include <cstdint>
#include <span>

namespace envmap::uastc_hdr {

/// How a region's two ends are stored: as one colour and how much darker the other is in all channels (mode 7), or as
/// two colours (mode 11).
enum class Ends { base_and_scale = 7, two_colours = 11 };

inline constexpr int bytes_of(Ends ends) { return ends == Ends::base_and_scale ? 4 : 6; }

/// Beyond it an end, or what lies between two, would be infinite.
inline constexpr int largest_end = 3967;

using Rgb = std::array<int, 3>;

/// Bytes of a region, so many as bytes_of() says. @return 12 bits a channel, first and second end.
std::array<Rgb, 2> ends_of(Ends ends, std::span<const std::uint8_t> bytes);

/// How many values a byte may have, and which is nearest.
class ByteLevels {
 public:
  /// @param levels 40, 64, 80, 128, 192 or 256.
  explicit ByteLevels(int levels);
  [[nodiscard]] std::uint8_t value(int number) const { return values_[std::size_t(number)]; }
  [[nodiscard]] std::uint8_t number(std::uint8_t value) const { return numbers_[value]; }
  /// The nearest level whose first `kept` bits are the byte's.
  [[nodiscard]] std::uint8_t nearest(int byte, int kept) const {
    return nearest_[std::size_t(kept)][std::size_t(byte)];
  }

 private:
  std::array<std::uint8_t, 256> values_{}, numbers_{};
  std::array<std::array<std::uint8_t, 256>, 4> nearest_{};
};

/// The one of so many levels.
const ByteLevels& byte_levels(int levels);

struct StoredEnds {
  std::array<std::uint8_t, 6> bytes{};
  std::array<Rgb, 2> ends{};  ///< What is read back, in the order of ends_of().
};

/// The finest of the ways to store these ends. @param wanted on the scale of the 12 bits; the brighter end is the
/// second of what comes back. Of base_and_scale the ends are as far from each other in all channels.
StoredEnds store_ends(Ends ends, const ByteLevels& levels, std::array<std::array<float, 3>, 2> wanted);

}  // namespace envmap::uastc_hdr
