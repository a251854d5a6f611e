#include "envmap/io/block/integer_sequence.h"

#include <algorithm>
#include <array>
#include <bit>

namespace envmap::block {
namespace {

// What a count of levels is made of: base x 2^bits.
struct Parts {
  int base, bits;
};
Parts parts_of(int levels) {
  const int bits = std::countr_zero(unsigned(levels)), odd = levels >> bits;
  return odd == 1 ? Parts{1, bits} : Parts{odd, bits};
}

// Of each number of a group, how many bits of the group's trits or quints follow its own.
constexpr std::array<int, 5> trit_bits{2, 2, 1, 2, 1};
constexpr std::array<int, 3> quint_bits{3, 2, 2};
std::span<const int> group_of(int base) {
  return base == 3 ? std::span<const int>(trit_bits) : std::span<const int>(quint_bits);
}

using Digits = std::array<std::uint8_t, 5>;

Digits trits_of(unsigned t) {
  const auto bit = [](unsigned x, int k) { return x >> k & 1; };
  const auto digit = [](unsigned x) { return std::uint8_t(x); };
  Digits d{};
  unsigned c = t & 31;
  if ((t >> 2 & 7) == 7) {
    c = (t >> 5 & 7) << 2 | (t & 3);
    d[4] = d[3] = 2;
  } else if ((t >> 5 & 3) == 3) {
    d[4] = 2, d[3] = digit(bit(t, 7));
  } else {
    d[4] = digit(bit(t, 7)), d[3] = digit(t >> 5 & 3);
  }
  if ((c & 3) == 3) {
    d[2] = 2, d[1] = digit(bit(c, 4)), d[0] = digit(bit(c, 3) << 1 | (bit(c, 2) & ~bit(c, 3) & 1));
  } else if ((c >> 2 & 3) == 3) {
    d[2] = d[1] = 2, d[0] = digit(c & 3);
  } else {
    d[2] = digit(bit(c, 4)), d[1] = digit(c >> 2 & 3), d[0] = digit(bit(c, 1) << 1 | (bit(c, 0) & ~bit(c, 1) & 1));
  }
  return d;
}

Digits quints_of(unsigned q) {
  const auto bit = [](unsigned x, int k) { return x >> k & 1; };
  const auto digit = [](unsigned x) { return std::uint8_t(x); };
  Digits d{};
  if ((q >> 1 & 3) == 3 && (q >> 5 & 3) == 0) {
    d[2] = digit(bit(q, 0) << 2 | (bit(q, 4) & ~bit(q, 0) & 1) << 1 | (bit(q, 3) & ~bit(q, 0) & 1));
    d[1] = d[0] = 4;
    return d;
  }
  unsigned c = q & 31;
  if ((q >> 1 & 3) == 3) {
    d[2] = 4, c = (q >> 3 & 3) << 3 | (~(q >> 5) & 3) << 1 | bit(q, 0);
  } else {
    d[2] = digit(q >> 5 & 3);
  }
  if ((c & 7) == 5) {
    d[1] = 4, d[0] = digit(c >> 3 & 3);
  } else {
    d[1] = digit(c >> 3 & 3), d[0] = digit(c & 7);
  }
  return d;
}

// The word of a group's digits: the least, so that digits that are left out take no bits.
std::uint8_t word_of(int base, const Digits& digits) {
  static const auto words = [] {
    std::array<std::array<std::uint8_t, 243>, 2> made{};
    const auto number = [](const Digits& d, int b) {
      return std::size_t((((d[4] * b + d[3]) * b + d[2]) * b + d[1]) * b + d[0]);
    };
    for (unsigned t = 256; t-- > 0;) made[0][number(trits_of(t), 3)] = std::uint8_t(t);
    for (unsigned q = 128; q-- > 0;) made[1][number(quints_of(q), 5)] = std::uint8_t(q);
    return made;
  }();
  std::size_t number = 0;
  for (std::size_t k = digits.size(); k-- > 0;) number = number * std::size_t(base) + digits[k];
  return words[base == 3 ? 0 : 1][number];
}

// Bits of a number spread as "unquantization" does: a word like "b000b0bb0", the highest bit first, with a for the
// lowest bit of the number.
int spread(const char* word, int bits) {
  int made = 0;
  for (; *word; ++word) made = made << 1 | (*word == '0' ? 0 : bits >> (*word - 'a') & 1);
  return made;
}

}  // namespace

int sequence_bits(int count, int levels) {
  const auto [base, bits] = parts_of(levels);
  return count * bits + (base == 3 ? (8 * count + 4) / 5 : base == 5 ? (7 * count + 2) / 3 : 0);
}

void take_sequence(Bits& bits, int levels, std::span<std::uint8_t> numbers) {
  const auto [base, own] = parts_of(levels);
  if (base == 1) {
    for (std::uint8_t& n : numbers) n = std::uint8_t(bits.take(own));
    return;
  }
  const std::span<const int> group = group_of(base);
  for (std::size_t first = 0; first < numbers.size(); first += group.size()) {
    const auto some = numbers.subspan(first, std::min(group.size(), numbers.size() - first));
    unsigned word = 0;
    for (std::size_t k = 0, at = 0; k < some.size(); at += std::size_t(group[k]), ++k) {
      some[k] = std::uint8_t(bits.take(own));
      word |= bits.take(group[k]) << at;
    }
    const Digits digits = base == 3 ? trits_of(word) : quints_of(word);
    for (std::size_t k = 0; k < some.size(); ++k) some[k] = std::uint8_t(some[k] | digits[k] << own);
  }
}

void put_sequence(Bits& bits, int levels, std::span<const std::uint8_t> numbers) {
  const auto [base, own] = parts_of(levels);
  if (base == 1) {
    for (const std::uint8_t n : numbers) bits.put(n, own);
    return;
  }
  const std::span<const int> group = group_of(base);
  for (std::size_t first = 0; first < numbers.size(); first += group.size()) {
    const auto some = numbers.subspan(first, std::min(group.size(), numbers.size() - first));
    Digits digits{};
    for (std::size_t k = 0; k < some.size(); ++k) digits[k] = std::uint8_t(some[k] >> own);
    const unsigned word = word_of(base, digits);
    for (std::size_t k = 0, at = 0; k < some.size(); at += std::size_t(group[k]), ++k) {
      bits.put(some[k] & ((1U << own) - 1), own);
      bits.put(word >> at & ((1U << group[k]) - 1), group[k]);
    }
  }
}

int byte_of(int number, int levels) {
  const auto [base, bits] = parts_of(levels);
  if (base == 1) {
    int byte = 0;
    for (int at = 8 - bits; at > -bits; at -= bits) byte |= at >= 0 ? number << at : number >> -at;
    return byte;
  }
  // Of trits with 6 bits; of quints with 3 and 4.
  const char* const word = base == 3 ? "fedcb000f" : bits == 3 ? "cb0000cbc" : "dcb0000dc";
  const int step = base == 3 ? 5 : bits == 3 ? 26 : 13;
  const int all = number & 1 ? 0x1ff : 0;
  const int t = ((number >> bits) * step + spread(word, number)) ^ all;
  return (all & 0x80) | t >> 2;
}

int weight_of(int number, int levels) {
  const auto [base, bits] = parts_of(levels);
  int weight = 0;
  if (levels == 3 || levels == 5) {
    constexpr int thirds[] = {0, 32, 63}, fifths[] = {0, 16, 32, 47, 63};
    weight = levels == 3 ? thirds[number] : fifths[number];
  } else if (base == 1) {
    for (int at = 6 - bits; at > -bits; at -= bits) weight |= at >= 0 ? number << at : number >> -at;
  } else {  // Trits with 1 and 2 bits, quints with 1.
    const int step = base == 5 ? 28 : bits == 1 ? 50 : 23, all = number & 1 ? 0x7f : 0;
    const int t = ((number >> bits) * step + (bits == 2 ? spread("b000b0b", number) : 0)) ^ all;
    weight = (all & 0x20) | t >> 2;
  }
  return weight > 32 ? weight + 1 : weight;
}

}  // namespace envmap::block
