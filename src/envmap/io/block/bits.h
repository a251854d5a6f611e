/// @file
/// The 128 bits of a block, from the lowest on.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>

#include "envmap/io/block/texel_block.h"

namespace envmap::block {

class Bits {
 public:
  Bits() = default;
  explicit Bits(std::span<const std::byte, block_bytes> from) { std::memcpy(words_.data(), from.data(), block_bytes); }
  [[nodiscard]] std::span<const std::byte> as_bytes() const { return std::as_bytes(std::span(words_)); }

  /// Bits from a position on, lowest first.
  [[nodiscard]] std::uint32_t at(int position, int count) const {
    std::uint32_t value = 0;
    for (int k = 0; k < count; ++k, ++position)
      value |= std::uint32_t(words_[std::size_t(position) / 64] >> position % 64 & 1) << k;
    return value;
  }
  std::uint32_t take(int count) {
    const std::uint32_t value = at(at_, count);
    at_ += count;
    return value;
  }
  void put(std::uint32_t value, int count) {
    for (int k = 0; k < count; ++k, ++at_) words_[std::size_t(at_) / 64] |= std::uint64_t{value >> k & 1} << at_ % 64;
  }
  /// Goes on reading or writing there.
  void go_to(int position) { at_ = position; }
  /// The last bit first.
  [[nodiscard]] Bits reversed() const {
    Bits bits;
    for (int k = 0; k < 8 * block_bytes; ++k) bits.put(at(8 * block_bytes - 1 - k, 1), 1);
    bits.at_ = 0;
    return bits;
  }
  Bits& operator|=(const Bits& other) {
    for (std::size_t k = 0; k < words_.size(); ++k) words_[k] |= other.words_[k];
    return *this;
  }

 private:
  std::array<std::uint64_t, 2> words_{};
  int at_ = 0;
};

}  // namespace envmap::block
