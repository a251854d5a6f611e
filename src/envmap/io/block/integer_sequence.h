/// @file
/// ASTC's bounded integer sequences: numbers of any of these counts of levels, which are bits and, where the count is a
/// multiple of 3 or 5, a trit or quint; five trits share 8 bits, three quints 7. Source: Khronos, "Data Format
/// Specification" 1.4, "ASTC compressed texture image formats", integer sequence encoding, endpoint and weight
/// unquantization.
#pragma once

#include <cstdint>
#include <span>

#include "envmap/io/block/bits.h"

namespace envmap::block {

/// Bits that so many numbers take.
int sequence_bits(int count, int levels);

/// From where `bits` stands on.
void take_sequence(Bits& bits, int levels, std::span<std::uint8_t> numbers);
void put_sequence(Bits& bits, int levels, std::span<const std::uint8_t> numbers);

/// What a number stands for as a byte of an endpoint. @param levels from 40 to 256.
int byte_of(int number, int levels);

/// What a number stands for as a weight, 0 to 64. @param levels from 3 to 16.
int weight_of(int number, int levels);

}  // namespace envmap::block
