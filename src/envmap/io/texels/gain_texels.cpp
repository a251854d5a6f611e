#include "envmap/io/texels/gain_texels.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "envmap/base/parallel.h"
#include "envmap/io/claims/srgb.h"
#include "envmap/maths/portable.h"

namespace envmap {
namespace {

// Reaches 1 at infinity, with a slope of 1 where it begins.
float rolled_off(float value) {
  constexpr float begin = 0.75F, room = 1 - begin;
  return value < begin ? value : 1 - room * room / (value - begin + room);
}

void roll_off(std::span<Colour> row, bool keeps_hue) {
  for (Colour& c : row) {
    const float largest = std::max(c.x, std::max(c.y, c.z));
    if (!keeps_hue)
      c = Colour(rolled_off(c.x), rolled_off(c.y), rolled_off(c.z));
    else if (largest > 0)
      c *= rolled_off(largest) / largest;
  }
}

unsigned char byte_of(double share) { return static_cast<unsigned char>(std::clamp(255 * share + 0.5, 0.0, 255.0)); }

// Linear light of every byte.
std::vector<Colour> light_of_bytes() {
  std::vector<Colour> light;
  for (int k = 0; k < 256; ++k) light.emplace_back(float(k) * (1.0F / 255));
  decode_srgb(light);
  return light;
}

// Powers of two make decimals and fractions that say the same number.
constexpr double steps_of_numbers = 1 << 16;
double rounded_down(double number) { return std::floor(number * steps_of_numbers) / steps_of_numbers; }
double rounded_up(double number) { return std::ceil(number * steps_of_numbers) / steps_of_numbers; }

// Sums of a row, of texels below and above white.
struct Sums {
  std::array<double, 2> maximum = {}, squares = {};
  std::array<std::int64_t, 2> texels = {};
};

Deviation total(const std::vector<Sums>& rows, std::size_t side) {
  Deviation d;
  double squares = 0;
  for (const Sums& s : rows)
    d.maximum = std::max(d.maximum, s.maximum[side]), squares += s.squares[side], d.texels += s.texels[side];
  if (d.texels > 0) d.rms = std::sqrt(squares / (3.0 * double(d.texels)));
  return d;
}

}  // namespace

std::vector<unsigned char> picture_of(const Light& light, std::optional<Display> display, bool keeps_hue) {
  std::vector<unsigned char> bytes(3 * light.texels.size());
  const std::size_t width = std::size_t(light.width);
  parallel_for(light.height, [&](int y) {
    const auto from = light.texels.subspan(std::size_t(y) * width, width);
    std::vector<Colour> row(from.begin(), from.end());
    if (display)
      show(row, *display);
    else
      roll_off(row, keeps_hue);
    for (Colour& c : row) c = glm::clamp(c, 0.0F, 1.0F);
    encode_srgb(row);
    unsigned char* to = bytes.data() + 3 * std::size_t(y) * width;
    for (const Colour& c : row)
      for (int k = 0; k < 3; ++k) *to++ = byte_of(c[k]);
  });
  return bytes;
}

Gains gains_between(std::span<const unsigned char> picture, const Light& light, int channels, int side, double offset) {
  Gains gains{light.width / side, light.height / side, channels, offset, {}};
  const std::size_t across = std::size_t(gains.width);
  gains.stops.resize(across * std::size_t(gains.height) * std::size_t(channels));
  const std::vector<Colour> linear = light_of_bytes();
  parallel_for(gains.height, [&](int y) {
    std::vector<Flux> is(across), shown(across);
    for (int j = 0; j < side; ++j)
      for (std::size_t x = 0; x < across * std::size_t(side); ++x) {
        const std::size_t k = std::size_t(y * side + j) * std::size_t(light.width) + x;
        is[x / std::size_t(side)] += Flux(light.texels[k]);
        for (int c = 0; c < 3; ++c)
          shown[x / std::size_t(side)][c] += double{linear[picture[3 * k + std::size_t(c)]][c]};
      }
    float* to = gains.stops.data() + std::size_t(y) * across * std::size_t(channels);
    const auto stops = [&](double a, double b, double texels) {
      return float(portable::log2((a / texels + offset) / (b / texels + offset)));
    };
    const double texels = 1.0 * side * side;
    for (std::size_t x = 0; x < across; ++x)
      if (channels == 1)
        *to++ = stops(is[x].x + is[x].y + is[x].z, shown[x].x + shown[x].y + shown[x].z, 3 * texels);
      else
        for (int c = 0; c < 3; ++c) *to++ = stops(is[x][c], shown[x][c], texels);
  });
  return gains;
}

GainMap gain_map_of(const Gains& gains, double gamma) {
  const auto [least, most] = std::ranges::minmax(gains.stops);
  GainMap map{.metadata = "ISO 21496-1", .width = gains.width, .height = gains.height, .channels = gains.channels};
  // Pictures without highlights have some range, too: readers divide by it.
  constexpr double least_range = 1.0 / 16;
  const double from = rounded_down(std::min(double{least}, 0.0)), to = std::max(rounded_up(most), from + least_range);
  map.of.fill({.least = from, .most = to, .gamma = gamma, .base_offset = gains.offset, .offset = gains.offset});
  map.headroom = std::max(to, least_range);
  map.values.resize(gains.stops.size());
  parallel_ranges(int(gains.stops.size()), 1 << 14, [&](int begin, int end) {
    for (std::size_t k = std::size_t(begin); k < std::size_t(end); ++k) {
      const double share = std::clamp((double{gains.stops[k]} - from) / (to - from), 0.0, 1.0);
      map.values[k] = byte_of(gamma == 1 ? share : gamma == 0.5 ? std::sqrt(share) : portable::pow(share, gamma));
    }
  });
  return map;
}

double GainMapError::maximum() const { return std::max(above.maximum, below.maximum); }

double GainMapError::rms() const {
  const double a = double(above.texels), b = double(below.texels);
  return a + b > 0 ? std::sqrt((above.rms * above.rms * a + below.rms * below.rms * b) / (a + b)) : 0;
}

GainMapError deviation(const Light& light, double floor,
                       const std::function<void(int row, std::span<Colour> out)>& read_row) {
  const std::size_t width = std::size_t(light.width);
  const std::vector<Sums> rows = map_rows<Sums>(light.height, [&](int y) {
    std::vector<Colour> row(width);
    read_row(y, row);
    Sums sums;
    for (std::size_t x = 0; x < width; ++x) {
      const Colour is = light.texels[std::size_t(y) * width + x];
      const std::size_t side = std::max(is.x, std::max(is.y, is.z)) > 1 ? 1 : 0;
      ++sums.texels[side];
      for (int c = 0; c < 3; ++c) {
        const double off = std::abs(double{row[x][c]} - is[c]);
        if (off == 0) continue;
        const double error = off / std::max(double{is[c]}, floor);
        sums.maximum[side] = std::max(sums.maximum[side], error);
        sums.squares[side] += error * error;
      }
    }
    return sums;
  });
  return {total(rows, 1), total(rows, 0)};
}

GainMapError deviation(const Light& light, double floor, std::span<const unsigned char> picture, const GainMap& map) {
  const std::vector<Colour> linear = light_of_bytes();
  const std::size_t width = std::size_t(light.width);
  return deviation(light, floor, [&](int y, std::span<Colour> row) {
    for (std::size_t x = 0; x < width; ++x) {
      const std::size_t at = 3 * (std::size_t(y) * width + x);
      row[x] = Colour(linear[picture[at]].x, linear[picture[at + 1]].y, linear[picture[at + 2]].z);
    }
    apply_gain(map, 1, y, light.height, row);
  });
}

}  // namespace envmap
