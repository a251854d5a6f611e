#include "envmap/io/fit_gain_map.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "envmap/base/error.h"
#include "envmap/base/parallel.h"
#include "envmap/io/formats/gain_map_jpeg.h"
#include "envmap/io/formats/jpeg.h"
#include "envmap/io/formats/jpeg_encoder.h"
#include "envmap/io/images/open_image.h"
#include "envmap/maths/portable.h"

namespace envmap {
namespace {

// Readers allot as many.
constexpr std::int64_t most_texels = 1 << 28;

constexpr int usual_quality = 95, best_quality = 100;
constexpr int gain_qualities[] = {20, 35, 50, 65, 75, 82, 88, 92, 95, 96, 97, 98, 99, 100};
// The picture is looked at by itself, too: an error limit does not make it worse than this.
constexpr int good_pictures[] = {100, 98, 95, 90};
constexpr int worst_picture = 20, all_pictures[] = {100, 98, 95, 92, 88, 82, 75, 65, 50, 35, worst_picture};
// 1/2 gives dark gains, of which there are most, finer steps.
constexpr double gammas[] = {1, 0.5};
constexpr int sides[] = {4, 2, 1};

// Dark texels count from half of the floor on; readers that take offsets for others are hardly wrong.
double offset_for(double floor) {
  return portable::exp2(std::clamp(std::round(portable::log2(floor / 2)), -14.0, -10.0));
}

class Fit {
 public:
  Fit(const Light& light, double floor, const GainMapOptions& how, const GainMapTexts& texts)
      : light_(light),
        floor_(floor),
        how_(how),
        texts_(texts),
        picture_(picture_of(light, how.display, how.channels == 1)) {}

  FittedGainMap for_eyes() const {
    const Picture picture = encoded(usual_quality);
    FittedGainMap best = made(picture, gains(picture, {1, gammas[0]}), usual_quality);
    FittedGainMap other = made(picture, gains(picture, {1, gammas[1]}), usual_quality);
    return other.error.rms() < best.error.rms() ? other : best;
  }

  // The smallest file in which no texel is off by more.
  FittedGainMap within_error(double most) const {
    Best smallest;
    FittedGainMap closest;
    closest.error.above.maximum = std::numeric_limits<double>::infinity();
    std::vector<Kind> kinds = all_kinds();
    for (const int quality : good_pictures) {
      const Picture picture = encoded(quality);
      std::vector<Found> found = each<Found>(kinds, [&](const Kind& kind) { return with_error(picture, kind, most); });
      std::vector<Kind> held;
      for (std::size_t k = 0; k < kinds.size(); ++k) {
        if (found[k].finest.error.maximum() < closest.error.maximum()) closest = std::move(found[k].finest);
        if (found[k].best.found || kinds[k].side == 1) held.push_back(kinds[k]);
        keep(std::move(found[k].best), smallest, [](const FittedGainMap& f) { return double(f.bytes.size()); });
      }
      kinds = std::move(held);  // What the best picture does not do with coarse gains, others do not either.
    }
    if (!smallest.found) refuse_error(closest);
    return smallest.file;
  }

  // The least rms error of files that are not larger.
  FittedGainMap within_bytes(std::uint64_t most) const {
    const std::vector<Kind> kinds = all_kinds();
    Best closest;
    std::uint64_t least = std::numeric_limits<std::uint64_t>::max();
    int worse = 0;  // Pictures in a row that made it no better.
    for (const int quality : all_pictures) {
      std::string jpeg = encode_jpeg({light_.width, light_.height, 3, picture_}, quality);
      if (jpeg.size() >= most && quality != worst_picture) continue;
      const Picture picture = decoded(quality, std::move(jpeg));
      bool better = false;
      for (Found& found : each<Found>(kinds, [&](const Kind& kind) { return with_bytes(picture, kind, most); })) {
        least = std::min<std::uint64_t>(least, found.least);
        better |= keep(std::move(found.best), closest, [](const FittedGainMap& f) { return f.error.rms(); });
      }
      worse = better ? 0 : worse + 1;
      if (closest.found && worse > 1) break;
    }
    if (!closest.found) throw AccuracyError(fmt::format("the smallest file has {} bytes", least));
    return closest.file;
  }

 private:
  struct Picture {
    int quality;
    std::string jpeg;
    std::vector<unsigned char> texels;  // As readers find them.
  };
  struct Best {
    bool found = false;
    FittedGainMap file = {};
  };

  // How many texels of the picture share a gain, across and down, and the curve of the gains.
  struct Kind {
    int side;
    double gamma;
  };
  struct Found {
    Best best;
    FittedGainMap finest = {};                                        // With the best quality.
    std::uint64_t least = std::numeric_limits<std::uint64_t>::max();  // Bytes of the smallest file.
  };

  // Readers want one shape of both images.
  [[nodiscard]] std::vector<Kind> all_kinds() const {
    std::vector<Kind> kinds;
    for (const int side : sides)
      for (const double gamma : gammas)
        if (light_.width % side == 0 && light_.height % side == 0) kinds.push_back({side, gamma});
    return kinds;
  }

  // libjpeg works in one thread.
  template <class Result, class F>
  static std::vector<Result> each(const std::vector<Kind>& kinds, const F& f) {
    return map_rows<Result>(int(kinds.size()), [&](int k) { return f(kinds[std::size_t(k)]); });
  }

  // @param cost of two files the one that costs less is kept, of equals the first. @return whether it is the new one.
  template <class Cost>
  static bool keep(Best made, Best& best, const Cost& cost) {
    if (!made.found || (best.found && cost(made.file) >= cost(best.file))) return false;
    best = std::move(made);
    return true;
  }

  [[nodiscard]] static Picture decoded(int quality, std::string jpeg) {
    std::vector<unsigned char> texels = decode_jpeg(jpeg);
    return {quality, std::move(jpeg), std::move(texels)};
  }
  [[nodiscard]] Picture encoded(int quality) const {
    return decoded(quality, encode_jpeg({light_.width, light_.height, 3, picture_}, quality));
  }

  [[nodiscard]] GainMap gains(const Picture& picture, const Kind& kind) const {
    return gain_map_of(gains_between(picture.texels, light_, how_.channels, kind.side, offset_for(floor_)), kind.gamma);
  }

  // The file, whose error is not known yet.
  [[nodiscard]] FittedGainMap packed(const Picture& picture, const GainMap& map, int quality, std::string& jpeg) const {
    jpeg = encode_jpeg({map.width, map.height, map.channels, map.values}, quality);
    FittedGainMap file{.picture_quality = picture.quality, .gain_quality = quality};
    file.map = map;
    file.map.values.clear();
    file.bytes = gain_map_jpeg({picture.jpeg, jpeg, map, texts_.icc_profile, texts_.comment, texts_.owner});
    return file;
  }
  void measure(const Picture& picture, const std::string& jpeg, FittedGainMap& file) const {
    GainMap read = file.map;
    read.values = decode_jpeg(jpeg);
    file.error = deviation(light_, floor_, picture.texels, read);
  }
  [[nodiscard]] FittedGainMap made(const Picture& picture, const GainMap& map, int quality) const {
    std::string jpeg;
    FittedGainMap file = packed(picture, map, quality, jpeg);
    measure(picture, jpeg, file);
    return file;
  }

  // The least quality that keeps to the error.
  [[nodiscard]] Found with_error(const Picture& picture, const Kind& kind, double most) const {
    const GainMap map = gains(picture, kind);
    // What the reader rounds in another way, of profiles.
    const auto holds = [&](const FittedGainMap& file) { return file.error.maximum() <= 0.9999 * most; };
    Found found;
    found.finest = made(picture, map, best_quality);
    if (!holds(found.finest)) return found;
    found.best = {true, found.finest};
    for (std::size_t below = 0, above = std::size(gain_qualities) - 1; below < above;) {
      const std::size_t middle = (below + above) / 2;
      FittedGainMap file = made(picture, map, gain_qualities[middle]);
      const bool held = holds(file);
      if (held) found.best.file = std::move(file);
      (held ? above : below) = held ? middle : middle + 1;
    }
    return found;
  }

  // The best quality, up to the picture's, that there is room for.
  [[nodiscard]] Found with_bytes(const Picture& picture, const Kind& kind, std::uint64_t most) const {
    const GainMap map = gains(picture, kind);
    Found found;
    std::string jpeg;
    const auto* const end = std::upper_bound(std::begin(gain_qualities), std::end(gain_qualities), picture.quality);
    std::size_t fit = 0, beyond = std::size_t(end - std::begin(gain_qualities));
    while (fit < beyond) {
      const std::size_t middle = (fit + beyond) / 2;
      std::string now;
      FittedGainMap file = packed(picture, map, gain_qualities[middle], now);
      found.least = std::min<std::uint64_t>(found.least, file.bytes.size());
      if (file.bytes.size() > most) {
        beyond = middle;
        continue;
      }
      found.best = {true, std::move(file)};
      jpeg = std::move(now), fit = middle + 1;
    }
    if (found.best.found) measure(picture, jpeg, found.best.file);
    return found;
  }

  [[noreturn]] static void refuse_error(const FittedGainMap& closest) {
    throw AccuracyError(
        fmt::format("the least error that can be reached is {:.1e}, {:.1e} above white and {:.1e} below "
                    "({})",
                    closest.error.maximum(), closest.error.above.maximum, closest.error.below.maximum,
                    closest.map.words()));
  }

  const Light& light_;
  double floor_;
  const GainMapOptions& how_;
  const GainMapTexts& texts_;
  std::vector<unsigned char> picture_;
};

// Of light as the program's own reader finds it in the file.
GainMapError read_back(const std::string& bytes, const Light& light, double floor) {
  Image image;
  open_bytes(image, "", bytes);
  std::vector<Colour> all(light.texels.size());
  image.read(0, 0, light.height, 0, 3, {&all.data()->x, 3 * all.size()});
  const std::size_t width = std::size_t(light.width);
  return deviation(light, floor, [&](int y, std::span<Colour> out) {
    std::copy_n(all.begin() + std::ptrdiff_t(std::size_t(y) * width), width, out.begin());
  });
}

}  // namespace

FittedGainMap fit_gain_map(const Light& light, double floor, const GainMapOptions& how, const GainMapTexts& texts) {
  if (std::int64_t{light.width} * light.height > most_texels)
    throw OutputError(fmt::format("a gain map has {} texels at most", most_texels));
  const Fit fit(light, floor, how, texts);
  FittedGainMap file = how.max_error   ? fit.within_error(*how.max_error)
                       : how.max_bytes ? fit.within_bytes(*how.max_bytes)
                                       : fit.for_eyes();
  file.error = read_back(file.bytes, light, floor);
  if (how.max_error && file.error.maximum() > *how.max_error)
    throw AccuracyError(fmt::format("the error is {:.6g}", file.error.maximum()));
  if (how.max_bytes && file.bytes.size() > *how.max_bytes)
    throw AccuracyError(fmt::format("the smallest file within this error has {} bytes", file.bytes.size()));
  return file;
}

}  // namespace envmap
