#include "envmap/io/block/uastc_hdr_endpoints.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <map>
#include <string_view>
#include <utility>

#include "envmap/io/block/integer_sequence.h"

namespace envmap::uastc_hdr {
namespace {

// A number in the bytes: its lowest bits fill the lower part of the byte that has its place in the list. What is left
// of it is scattered over the upper bits of others.
struct Scattered {
  std::uint8_t byte, bit, number, of_bit;
};

struct Layout {
  int shift;                  // Of the numbers, to 12 bits.
  std::array<int, 6> bits;    // Of each number.
  std::array<int, 6> lowest;  // Of those, in its own byte.
  std::array<Scattered, 8> scattered;
  int count;
};

// The lists of the specification: the number and its bit that each of the bits x0, x1 ... holds; a dot where it belongs
// to its byte's own number.
constexpr std::array<Scattered, 8> scatter(std::string_view list, std::string_view names,
                                           std::array<std::pair<int, int>, 8> places, int& count) {
  std::array<Scattered, 8> made{};
  count = 0;
  for (std::size_t x = 0; !list.empty(); ++x) {
    const std::size_t end = std::min(list.find(' '), list.size());
    const std::string_view word = list.substr(0, end);
    list.remove_prefix(std::min(end + 1, list.size()));
    if (word == ".") continue;
    int bit = 0;
    for (const char digit : word.substr(1)) bit = 10 * bit + (digit - '0');
    made[std::size_t(count++)] = {std::uint8_t(places[x].first), std::uint8_t(places[x].second),
                                  std::uint8_t(names.find(word[0])), std::uint8_t(bit)};
  }
  return made;
}

// Mode 7: of red (the largest channel), green and blue (how much less the others have) and the scale.
constexpr Layout scale_layout(int shift, std::array<int, 6> bits, std::string_view list) {
  Layout l{shift, bits, {6, 5, 5, 5}, {}, 0};
  l.scattered = scatter(list, "rgbs", {{{1, 6}, {1, 5}, {2, 6}, {2, 5}, {3, 7}, {3, 6}, {3, 5}}}, l.count);
  return l;
}
constexpr std::array<Layout, 6> scale_layouts{
    scale_layout(1, {11, 5, 5, 7}, "r9 r8 r7 r10 r6 s6 s5"), scale_layout(1, {11, 6, 6, 5}, "r8 g5 r7 b5 r6 r10 r9"),
    scale_layout(2, {10, 5, 5, 8}, "r9 r8 r7 r6 s7 s6 s5"),  scale_layout(3, {9, 6, 6, 7}, "r8 g5 r7 b5 r6 s6 s5"),
    scale_layout(4, {8, 7, 7, 6}, "g6 g5 b6 b5 r6 r7 s5"),   scale_layout(5, {7, 7, 7, 7}, "g6 g5 b6 b5 r6 s6 s5"),
};

// Mode 11: a is the second end's largest channel; c how much less the first has; p and q how much less the second end's
// other channels have, and d and e what the first has less than all that.
constexpr Layout colour_layout(int shift, std::array<int, 6> bits, std::string_view list) {
  Layout l{shift, bits, {8, 6, 6, 6, bits[4], bits[5]}, {}, 0};
  l.scattered = scatter(list, "acpqde", {{{1, 6}, {2, 6}, {3, 6}, {4, 6}, {5, 6}, {4, 5}, {5, 5}}}, l.count);
  return l;
}
constexpr std::array<Layout, 8> colour_layouts{
    colour_layout(3, {9, 6, 7, 7, 7, 7}, "a8 p6 q6"),
    colour_layout(3, {9, 6, 8, 8, 6, 6}, "a8 p6 q6 p7 q7"),
    colour_layout(2, {10, 7, 6, 6, 7, 7}, "a8 a9 c6"),
    colour_layout(2, {10, 7, 7, 7, 6, 6}, "a8 p6 q6 a9 c6"),
    colour_layout(1, {11, 6, 8, 8, 5, 5}, "a8 p6 q6 p7 q7 a9 a10"),
    colour_layout(1, {11, 8, 6, 6, 6, 6}, "a8 a9 a10 c7 c6"),
    colour_layout(0, {12, 7, 7, 7, 5, 5}, "a8 p6 q6 a11 c6 a9 a10"),
    colour_layout(0, {12, 7, 6, 6, 6, 6}, "a8 a9 a10 a11 c6"),
};

using Numbers = std::array<int, 6>;

Numbers numbers_of(const Layout& l, std::span<const std::uint8_t> bytes) {
  Numbers numbers{};
  for (std::size_t k = 0; k < bytes.size(); ++k) numbers[k] = bytes[k] & ((1 << l.lowest[k]) - 1);
  for (int x = 0; x < l.count; ++x) {
    const Scattered& s = l.scattered[std::size_t(x)];
    numbers[s.number] |= (bytes[s.byte] >> s.bit & 1) << s.of_bit;
  }
  return numbers;
}

int sign_extended(int value, int bits) {
  const int sign = 1 << (bits - 1);
  return ((value & (2 * sign - 1)) ^ sign) - sign;
}

Rgb clamped(Rgb c) {
  for (int& x : c) x = std::clamp(x, 0, 0xfff);
  return c;
}

Rgb with_largest_at(std::size_t channel, Rgb c) {
  std::swap(c[0], c[channel]);
  return c;
}

constexpr int direct_scale = 5;  // Of scale_layouts: red, green and blue as they are.

// The ends that numbers of a layout stand for.
std::array<Rgb, 2> scaled_ends(int mode, int largest, Numbers n) {
  for (int& x : n) x <<= scale_layouts[std::size_t(mode)].shift;
  const Rgb second = mode == direct_scale ? Rgb{n[0], n[1], n[2]} : Rgb{n[0], n[0] - n[1], n[0] - n[2]};
  const Rgb first{second[0] - n[3], second[1] - n[3], second[2] - n[3]};
  return {clamped(with_largest_at(std::size_t(largest), first)),
          clamped(with_largest_at(std::size_t(largest), second))};
}

std::array<Rgb, 2> coloured_ends(int mode, int largest, Numbers n) {
  for (int& x : n) x *= 1 << colour_layouts[std::size_t(mode)].shift;
  const auto [a, c, p, q, d, e] = n;
  return {clamped(with_largest_at(std::size_t(largest), {a - c, a - p - c - d, a - q - c - e})),
          clamped(with_largest_at(std::size_t(largest), {a, a - p, a - q}))};
}

std::array<Rgb, 2> scaled_ends(std::span<const std::uint8_t> v) {
  const int word = v[0] >> 6 | (v[1] >> 7) << 2 | (v[2] >> 7) << 3;
  const int mode = word < 12 ? word & 3 : word < 15 ? 4 : direct_scale;
  const int largest = word < 12 ? word >> 2 : word < 15 ? word & 3 : 0;
  return scaled_ends(mode, largest, numbers_of(scale_layouts[std::size_t(mode)], v));
}

std::array<Rgb, 2> coloured_ends(std::span<const std::uint8_t> v) {
  const int largest = v[4] >> 7 | (v[5] >> 7) << 1;
  if (largest == 3) return {{{v[0] << 4, v[2] << 4, (v[4] & 127) << 5}, {v[1] << 4, v[3] << 4, (v[5] & 127) << 5}}};
  const int mode = v[1] >> 7 | (v[2] >> 7) << 1 | (v[3] >> 7) << 2;
  const Layout& l = colour_layouts[std::size_t(mode)];
  Numbers n = numbers_of(l, v);
  for (std::size_t k = 4; k < 6; ++k) n[k] = sign_extended(n[k], l.bits[k]);
  return coloured_ends(mode, largest, n);
}

// Fills bytes in their order, so that what a byte's levels make of a number can be made good by those after it.
class Filling {
 public:
  Filling(const Layout& layout, const ByteLevels& levels) : layout_(layout), levels_(levels) {}

  // Number k as near to `wanted` as it can be stored. @param flags bits of its byte that are no number's.
  // @return whether it has the bits for it.
  bool put(std::size_t k, float wanted, int flags, bool has_sign = false) {
    const int unit = 1 << layout_.shift, bits = layout_.bits[k];
    const int least = has_sign ? -(1 << (bits - 1)) : 0, most = (1 << (bits - (has_sign ? 1 : 0))) - 1;
    const int number = int(std::floor(wanted / float(unit) + 0.5F));
    if ((has_sign && number < least) || number > most) return false;
    numbers[k] = std::max(number, least);  // Below 0 by rounding alone.
    int byte = flags | (numbers[k] & ((1 << layout_.lowest[k]) - 1));
    for (int x = 0; x < layout_.count; ++x) {
      const Scattered& s = layout_.scattered[std::size_t(x)];
      if (s.byte == k) byte |= (numbers[s.number] >> s.of_bit & 1) << s.bit;
    }
    bytes[k] = levels_.nearest(byte, 8 - layout_.lowest[k]);
    const int low = (1 << layout_.lowest[k]) - 1;
    numbers[k] = (numbers[k] & ~low) | (bytes[k] & low);
    if (has_sign) numbers[k] = sign_extended(numbers[k], bits);
    return true;
  }
  [[nodiscard]] float value(std::size_t k) const { return float(numbers[k] * (1 << layout_.shift)); }

  Numbers numbers{};
  std::array<std::uint8_t, 6> bytes{};

 private:
  const Layout& layout_;
  const ByteLevels& levels_;
};

using ColourPair = std::array<std::array<float, 3>, 2>;  // The two ends that a fit found.

std::size_t largest_of(const std::array<float, 3>& c) {
  return std::size_t(std::max_element(c.begin(), c.end()) - c.begin());
}

// Whether none of the channels would be read back as infinite.
bool is_finite(const std::array<Rgb, 2>& ends) {
  return std::ranges::all_of(ends, [](const Rgb& c) { return std::ranges::max(c) <= largest_end; });
}

bool store_scaled(int mode, const ByteLevels& levels, const ColourPair& wanted, StoredEnds& to) {
  const auto largest = largest_of(wanted[1]);
  std::array<float, 3> second = wanted[1];
  const float scale = std::max(0.0F, second[0] - wanted[0][0]);
  const bool direct = mode == direct_scale;
  if (!direct) std::swap(second[0], second[largest]);
  const int word = direct ? 15 : mode == 4 ? 12 | int(largest) : int(largest) << 2 | mode;
  Filling f(scale_layouts[std::size_t(mode)], levels);
  const int flags[] = {(word & 3) << 6, (word >> 2 & 1) << 7, (word >> 3 & 1) << 7, 0};
  if (!f.put(0, second[0], flags[0])) return false;
  for (std::size_t c = 1; c < 3; ++c)
    if (!f.put(c, direct ? second[c] : f.value(0) - second[c], flags[c])) return false;
  if (!f.put(3, scale, flags[3])) return false;
  to.bytes = f.bytes;
  to.ends = scaled_ends(mode, direct ? 0 : int(largest), f.numbers);
  return is_finite(to.ends);
}

// Whether numbers of the mode reach so far, but for what rounding of the first ones adds.
bool reaches(const Layout& l, const std::array<float, 6>& wanted) {
  for (std::size_t k = 1; k < 6; ++k)
    if (std::abs(wanted[k]) > float(1 << (l.bits[k] - (k < 4 ? 0 : 1) + l.shift))) return false;
  return true;
}

bool store_coloured(int mode, const ByteLevels& levels, const ColourPair& wanted, StoredEnds& to) {
  const auto largest = largest_of(wanted[1]);
  ColourPair w = wanted;
  for (auto& end : w) std::swap(end[0], end[largest]);
  const float c = w[1][0] - w[0][0], p = w[1][0] - w[1][1], q = w[1][0] - w[1][2];
  if (!reaches(colour_layouts[std::size_t(mode)], {0, c, p, q, w[1][1] - c - w[0][1], w[1][2] - c - w[0][2]}))
    return false;
  Filling f(colour_layouts[std::size_t(mode)], levels);
  const auto flag = [](int word, int bit) { return (word >> bit & 1) << 7; };
  if (!f.put(0, w[1][0], 0) || !f.put(1, f.value(0) - w[0][0], flag(mode, 0))) return false;
  if (!f.put(2, f.value(0) - w[1][1], flag(mode, 1)) || !f.put(3, f.value(0) - w[1][2], flag(mode, 2))) return false;
  const float first = f.value(0) - f.value(1);
  if (!f.put(4, first - f.value(2) - w[0][1], flag(int(largest), 0), true)) return false;
  if (!f.put(5, first - f.value(3) - w[0][2], flag(int(largest), 1), true)) return false;
  to.bytes = f.bytes;
  to.ends = coloured_ends(mode, int(largest), f.numbers);
  return is_finite(to.ends);
}

// Eight bits of red and green and seven of blue, which hold any ends.
void store_directly(const ByteLevels& levels, const ColourPair& wanted, StoredEnds& to) {
  for (std::size_t e = 0; e < 2; ++e)
    for (std::size_t c = 0; c < 3; ++c) {
      const int shift = c == 2 ? 5 : 4, most = largest_end >> shift;
      const int number = std::clamp(int(std::floor(wanted[e][c] / float(1 << shift) + 0.5F)), 0, most);
      int byte = levels.nearest(c == 2 ? number | 128 : number, c == 2 ? 1 : 0);
      for (int lower = number; (byte & (c == 2 ? 127 : 255)) > most; --lower)  // A level further down.
        byte = levels.nearest(c == 2 ? lower | 128 : lower, c == 2 ? 1 : 0);
      to.bytes[2 * c + e] = std::uint8_t(byte);
    }
  to.ends = coloured_ends(to.bytes);
}

// Seven bits a channel.
void store_scaled_directly(const ByteLevels& levels, ColourPair wanted, StoredEnds& to) {
  for (float most = largest_end; !store_scaled(direct_scale, levels, wanted, to); most -= 32)
    for (std::size_t c = 0; c < 3; ++c) {
      wanted[1][c] = std::clamp(wanted[1][c], 0.0F, most);
      wanted[0][c] = std::max(wanted[0][c], wanted[1][c] - most);
    }
}

}  // namespace

std::array<Rgb, 2> ends_of(Ends ends, std::span<const std::uint8_t> bytes) {
  return ends == Ends::base_and_scale ? scaled_ends(bytes.first(4)) : coloured_ends(bytes.first(6));
}

ByteLevels::ByteLevels(int levels) {
  for (int k = 0; k < levels; ++k) {
    values_[std::size_t(k)] = std::uint8_t(block::byte_of(k, levels));
    numbers_[values_[std::size_t(k)]] = std::uint8_t(k);
  }
  for (int kept = 0; kept < 4; ++kept)
    for (int byte = 0; byte < 256; ++byte) {
      int best = -1000;
      for (int k = 0; k < levels; ++k)
        if (const int v = values_[std::size_t(k)];
            v >> (8 - kept) == byte >> (8 - kept) && std::abs(v - byte) < std::abs(best - byte))
          best = v;
      nearest_[std::size_t(kept)][std::size_t(byte)] = std::uint8_t(best);
    }
}

const ByteLevels& byte_levels(int levels) {
  static const std::map<int, ByteLevels> all = [] {
    std::map<int, ByteLevels> made;
    for (const int n : {40, 64, 80, 128, 192, 256}) made.emplace(n, n);
    return made;
  }();
  return all.at(levels);
}

StoredEnds store_ends(Ends ends, const ByteLevels& levels, std::array<std::array<float, 3>, 2> wanted) {
  StoredEnds stored;
  for (auto& end : wanted)
    for (float& x : end) x = std::clamp(x, ends == Ends::base_and_scale ? -4096.0F : 0.0F, float(largest_end));
  if (std::ranges::max(wanted[0]) > std::ranges::max(wanted[1])) std::swap(wanted[0], wanted[1]);
  if (ends == Ends::base_and_scale) {
    for (float& x : wanted[1]) x = std::max(x, 0.0F);
    for (int mode = 0; mode < direct_scale; ++mode)
      if (store_scaled(mode, levels, wanted, stored)) return stored;
    store_scaled_directly(levels, wanted, stored);
    return stored;
  }
  for (int mode = int(colour_layouts.size()) - 1; mode >= 0; --mode)
    if (store_coloured(mode, levels, wanted, stored)) return stored;
  store_directly(levels, wanted, stored);
  return stored;
}

}  // namespace envmap::uastc_hdr
