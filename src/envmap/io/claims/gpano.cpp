#include "envmap/io/claims/gpano.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "envmap/base/error.h"
#include "envmap/io/claims/xmp.h"
#include "envmap/io/claims/xmp_packet.h"

namespace envmap {
namespace {

constexpr std::string_view space = "http://ns.google.com/photos/1.0/panorama/";
// The first packet that speaks of a panorama.
std::string packet_of(const Image& image) {
  for (std::string& packet : xmp_packets(*image.file, image.reader->format))
    if (packet.find(space) != packet.npos) return std::move(packet);
  return {};
}

}  // namespace

std::optional<Panorama> panorama_of(const Image& image) {
  if (!image.reader) return std::nullopt;
  const std::string packet = packet_of(image);
  if (packet.empty()) return std::nullopt;
  const std::vector<XmpNode> xmp = parse_xmp(packet);
  const auto number = [&](std::string_view name) { return xmp_number(xmp, space, name); };
  Panorama p{.heading = number("PoseHeadingDegrees"),
             .pitch = number("PosePitchDegrees"),
             .roll = number("PoseRollDegrees")};
  if (const auto said = xmp_values(xmp, space, "ProjectionType"); !said.empty()) p.projection = said.front();
  constexpr std::array<std::string_view, 6> names{"FullPanoWidthPixels",         "FullPanoHeightPixels",
                                                  "CroppedAreaImageWidthPixels", "CroppedAreaImageHeightPixels",
                                                  "CroppedAreaLeftPixels",       "CroppedAreaTopPixels"};
  std::array<std::optional<double>, names.size()> all;
  std::ranges::transform(names, all.begin(), number);
  if (std::ranges::none_of(all, [](const auto& n) { return n.has_value(); })) return p;
  for (std::size_t k = 0; k < names.size(); ++k)
    if (!all[k]) throw InputError(fmt::format("damaged: GPano XMP without {}", names[k]));
  p.crop = {*all[0], *all[1], *all[2], *all[3], *all[4], *all[5]};
  return p;
}

std::optional<DataWindow> window_in(const Panorama& p, int width, int height) {
  if (p.projection != "equirectangular")
    throw InputError(
        fmt::format("not supported: GPano projection '{}': only equirectangular is read as a map", p.projection));
  if (!p.crop) return std::nullopt;
  const Panorama::Crop& c = *p.crop;
  constexpr double most = 1 << 20;
  if (!(c.width >= 1 && c.height >= 1 && c.left >= 0 && c.top >= 0 && c.left + c.width <= c.full_width &&
        c.top + c.height <= c.full_height && c.full_width <= most))
    throw InputError(fmt::format("damaged: GPano crop of {}x{} at {},{} is not inside of its panorama of {}x{}",
                                 c.width, c.height, c.left, c.top, c.full_width, c.full_height));
  const double across = width / c.width, down = height / c.height;
  // Sides are rounded, each by itself.
  if (std::abs(across * c.height - height) > 1 && std::abs(down * c.width - width) > 1)
    throw InputError(fmt::format("damaged: GPano crop of {}x{} is not of the shape of its image, {}x{}", c.width,
                                 c.height, width, height));
  if (std::abs(c.full_width - 2 * c.full_height) > 2)
    throw InputError(
        fmt::format("not supported: GPano panorama of {}x{}: a whole sphere is 2:1", c.full_width, c.full_height));
  if (c.full_width - c.width < 1 && c.full_height - c.height < 1) return std::nullopt;
  const int rows = int(std::lround(down * c.full_height));
  const DataWindow window{std::lround(across * c.left), std::lround(down * c.top), 2 * rows, rows};
  if (window.x + width > window.width || window.y + height > window.height)
    throw InputError(
        fmt::format("damaged: GPano crop of {}x{} does not fit its image of {}x{}", c.width, c.height, width, height));
  return window;
}

// Right in the image is -X where +Z is in its middle: clockwise turns are those of negative yaw.
Rotation pose_of(const Panorama& p) {
  return rotation(-p.heading.value_or(0), -p.pitch.value_or(0), p.roll.value_or(0));
}

}  // namespace envmap
