#include "envmap/io/claims/gain_map.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "envmap/base/error.h"
#include "envmap/maths/portable.h"

namespace envmap {
namespace {

constexpr std::string_view hdrgm = "http://ns.adobe.com/hdr-gain-map/1.0/";

[[noreturn]] void refuse(const std::string& what) { throw InputError(what, Remedy::take_base); }

// What would make no light, or more of it than floats hold.
GainMap checked(GainMap map) {
  constexpr double most_stops = 100;
  for (const GainMap::Channel& c : map.of) {
    const bool finite = std::isfinite(c.base_offset) && std::isfinite(c.offset) && std::isfinite(c.gamma);
    if (!finite || !(c.gamma > 0) || !(c.least <= c.most) ||
        !(std::max(std::abs(c.least), std::abs(c.most)) < most_stops))
      refuse(fmt::format("damaged: a gain map of {} from {:g} to {:g} stops, gamma {:g}", map.metadata, c.least, c.most,
                         c.gamma));
  }
  if (!(map.headroom > map.base_headroom) || !(map.base_headroom >= 0) || !std::isfinite(map.headroom))
    refuse(fmt::format("damaged: a gain map of {} for {:g} to {:g} stops of headroom", map.metadata, map.base_headroom,
                       map.headroom));
  return map;
}

// ---- XMP ------------------------------------------------------------------------------------------------------------

// One number for all channels, or one for each.
void take(const std::vector<XmpNode>& xmp, const char* name, GainMap& map, double GainMap::Channel::*to) {
  const std::vector<std::string> values = xmp_values(xmp, hdrgm, name);
  if (values.empty()) return;
  for (std::size_t c = 0; c < 3; ++c) {
    const std::optional<double> number =
        values.size() == 1 || values.size() == 3 ? number_of(values[c % values.size()]) : std::nullopt;
    if (!number) refuse(fmt::format("damaged: XMP where hdrgm:{} is neither one nor three numbers", name));
    map.of[c].*to = *number;
  }
}

bool is_true(std::string text) {
  std::ranges::transform(text, text.begin(), [](unsigned char c) { return c >= 'A' && c <= 'Z' ? c + 32 : c; });
  return text == "true" || text == "1";
}

// ---- ISO 21496-1 ----------------------------------------------------------------------------------------------------

// Big-endian numbers; beyond the end an error.
class Numbers {
 public:
  explicit Numbers(std::span<const unsigned char> bytes) : bytes_(bytes) {}

  std::uint32_t get(std::size_t size) {
    if (size > bytes_.size()) refuse("damaged: the metadata of ISO 21496-1 ends too early");
    std::uint32_t number = 0;
    for (const unsigned char b : bytes_.first(size)) number = number << 8U | b;
    bytes_ = bytes_.subspan(size);
    return number;
  }
  [[nodiscard]] bool at_end() const { return bytes_.empty(); }

  /// Over one denominator for all, which drafts of the standard had, or one that follows.
  double fraction(bool is_signed) {
    const std::uint32_t above = get(4), below = common_ ? *common_ : get(4);
    if (below == 0) refuse("damaged: a fraction over 0 in the metadata of ISO 21496-1");
    return (is_signed ? double(std::int32_t(above)) : double(above)) / below;
  }
  void take_common() { common_ = get(4); }

 private:
  std::span<const unsigned char> bytes_;
  std::optional<std::uint32_t> common_;
};

// ---- the gain -------------------------------------------------------------------------------------------------------

// Two neighbours among `size` texels, and how much of the second is in what lies at the centre of texel k of `of`.
struct Between {
  int first, second;
  double part;
};

Between between(int k, int of, int size) {
  const double place = std::clamp((k + 0.5) * size / of - 0.5, 0.0, double(size - 1));
  const int first = int(place);
  return {first, std::min(first + 1, size - 1), place - first};
}

}  // namespace

double GainMap::weight(std::optional<double> stops) const {
  return stops ? std::clamp((*stops - base_headroom) / (headroom - base_headroom), 0.0, 1.0) : 1;
}

std::string GainMap::words() const {
  double least = of[0].least, most = of[0].most, step = 0;
  for (const Channel& c : of) {
    least = std::min(least, c.least), most = std::max(most, c.most);
    const auto stops = [&](int k) { return (c.most - c.least) * portable::pow(k / 255.0, 1 / c.gamma); };
    for (int k = 0; k < 255; ++k) step = std::max(step, stops(k + 1) - stops(k));
  }
  return fmt::format("{}, {:.4g} to {:.4g} stops in steps of {:.2g}%, {}x{} texels of {}", metadata, least, most,
                     100 * (portable::exp2(step) - 1), width, height, channels == 1 ? "1 channel" : "3 channels");
}

bool announces_gain_map(const std::vector<XmpNode>& xmp) { return !xmp_values(xmp, hdrgm, "Version").empty(); }

std::optional<GainMap> gain_map_of_xmp(const std::vector<XmpNode>& xmp) {
  if (xmp_values(xmp, hdrgm, "GainMapMax").empty()) return std::nullopt;
  const std::vector<std::string> version = xmp_values(xmp, hdrgm, "Version");
  GainMap map{.metadata = fmt::format("hdrgm {}", version.empty() ? "without a version" : version[0])};
  if (!version.empty() && !version[0].starts_with("1.")) refuse("not supported: a gain map of " + map.metadata);
  for (const std::string& hdr : xmp_values(xmp, hdrgm, "BaseRenditionIsHDR"))
    if (is_true(hdr)) refuse("not supported: a gain map that makes a picture of low range out of one of high range");
  take(xmp, "GainMapMin", map, &GainMap::Channel::least);
  take(xmp, "GainMapMax", map, &GainMap::Channel::most);
  take(xmp, "Gamma", map, &GainMap::Channel::gamma);
  take(xmp, "OffsetSDR", map, &GainMap::Channel::base_offset);
  take(xmp, "OffsetHDR", map, &GainMap::Channel::offset);
  map.base_headroom = xmp_number(xmp, hdrgm, "HDRCapacityMin").value_or(0);
  const std::optional<double> headroom = xmp_number(xmp, hdrgm, "HDRCapacityMax");
  if (!headroom) refuse("damaged: a gain map of XMP without hdrgm:HDRCapacityMax");
  map.headroom = *headroom;
  return checked(map);
}

std::optional<GainMap> gain_map_of_iso(std::span<const unsigned char> bytes) {
  constexpr unsigned of_three_channels = 0x80, of_base_colours = 0x40, backward = 4, common_denominator = 8;
  Numbers numbers(bytes);
  const std::uint32_t version = numbers.get(2);
  if (version != 0) refuse(fmt::format("not supported: a gain map of ISO 21496-1 from version {} on", version));
  numbers.get(2);  // Of the writer.
  if (numbers.at_end()) return std::nullopt;
  GainMap map{.metadata = "ISO 21496-1"};
  const unsigned flags = numbers.get(1);
  if (flags & backward) refuse("not supported: a gain map that makes a picture of low range out of one of high range");
  map.of_base_colours = flags & of_base_colours;
  if (flags & common_denominator) numbers.take_common();
  map.base_headroom = numbers.fraction(false);
  map.headroom = numbers.fraction(false);
  if (map.headroom < map.base_headroom)
    refuse("not supported: a gain map that makes a picture of low range out of one of high range");
  for (std::size_t c = 0; c < (flags & of_three_channels ? 3 : 1); ++c) {
    GainMap::Channel& channel = map.of[c];
    channel.least = numbers.fraction(true);
    channel.most = numbers.fraction(true);
    channel.gamma = numbers.fraction(false);
    channel.base_offset = numbers.fraction(true);
    channel.offset = numbers.fraction(true);
  }
  if (!(flags & of_three_channels)) map.of[1] = map.of[2] = map.of[0];
  return checked(map);
}

namespace {

// What the light of the base and its offset are multiplied by, of a share of 255ths.
double gain_of(const GainMap::Channel& of, double weight, double stored) {
  const double share = of.gamma == 1 ? stored : of.gamma == 0.5 ? stored * stored : portable::pow(stored, 1 / of.gamma);
  return portable::exp2(weight * (of.least * (1 - share) + of.most * share));
}

float lit(const GainMap::Channel& of, float base, double gain) {
  return float(std::max((double{base} + of.base_offset) * gain - of.offset, 0.0));
}

// Of a gain map as large as its picture, whose texels each have one of 256 gains.
void apply_texels(const GainMap& map, double weight, const unsigned char* texels, std::span<Colour> row) {
  std::array<std::array<double, 256>, 3> gains;
  for (std::size_t c = 0; c < 3; ++c)
    for (int k = 0; k < 256; ++k) gains[c][std::size_t(k)] = gain_of(map.of[c], weight, k / 255.0);
  for (std::size_t x = 0; x < row.size(); ++x)
    for (int c = 0; c < 3; ++c)
      row[x][c] =
          lit(map.of[std::size_t(c)], row[x][c],
              gains[std::size_t(c)][texels[x * std::size_t(map.channels) + (map.channels == 1 ? 0U : unsigned(c))]]);
}

}  // namespace

void apply_gain(const GainMap& map, double weight, int y, int height, std::span<Colour> row) {
  constexpr std::size_t narrow = 256;  // As wide as the table that apply_texels() makes.
  const std::size_t across = std::size_t(map.width) * std::size_t(map.channels);
  if (row.size() == std::size_t(map.width) && height == map.height && row.size() >= narrow)
    return apply_texels(map, weight, map.values.data() + std::size_t(y) * across, row);
  const Between rows = between(y, height, map.height);
  const auto value = [&](int j, int i, int c) {
    return map.values[std::size_t(j) * across + std::size_t(i) * std::size_t(map.channels) + std::size_t(c)];
  };
  for (std::size_t x = 0; x < row.size(); ++x) {
    const Between columns = between(int(x), int(row.size()), map.width);
    for (int c = 0; c < 3; ++c) {
      const GainMap::Channel& of = map.of[std::size_t(c)];
      const int k = map.channels == 1 ? 0 : c;
      const auto along = [&](int j) {
        return value(j, columns.first, k) * (1 - columns.part) + value(j, columns.second, k) * columns.part;
      };
      const double stored = (along(rows.first) * (1 - rows.part) + along(rows.second) * rows.part) / 255;
      row[x][c] = lit(of, row[x][c], gain_of(of, weight, stored));
    }
  }
}

}  // namespace envmap
