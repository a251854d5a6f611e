/// @file
/// The numbers of a TIFF structure, as Exif data and the index of a JPEG's further images have them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace envmap {

/// Numbers of one byte order. Outside of the bytes they are 0.
struct TiffNumbers {
  std::span<const unsigned char> bytes;
  bool little;

  [[nodiscard]] std::uint32_t get(std::size_t at, std::size_t size) const {
    std::uint32_t number = 0;
    for (std::size_t k = 0; k < size && at + size <= bytes.size(); ++k)
      number = number << 8U | bytes[at + (little ? size - 1 - k : k)];
    return number;
  }
};

}  // namespace envmap
