#include "envmap/io/images/picture.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "envmap/base/bounds.h"
#include "envmap/base/error.h"
#include "envmap/io/claims/srgb.h"
#include "envmap/io/files/output_file.h"
#include "envmap/io/formats/file_format.h"
#include "envmap/io/images/image_writer.h"

namespace envmap {
namespace {

using Radiance = Rgb<double>;

double largest(const Radiance& c) { return std::max(c.x, std::max(c.y, c.z)); }

// What a dielectric reflects at least, 0.04, is taken away, so that base colours come out as they are.
Radiance neutral(Radiance c) {
  constexpr double start = 0.8 - 0.04, room = 1 - start, desaturation = 0.15;
  const double least = std::min(c.x, std::min(c.y, c.z));
  c -= least < 0.08 ? least - 6.25 * least * least : 0.04;
  const double peak = largest(c);
  if (peak < start) return c;
  const double drawn_in = 1 - room * room / (peak + room - start);
  const double white = 1 - 1 / (desaturation * (peak - drawn_in) + 1);
  return glm::mix(c * (drawn_in / peak), Radiance(drawn_in), white);
}

Radiance shown(const Radiance& c, Display display) {
  switch (display) {
    case Display::reinhard: return c / (1.0 + c);
    case Display::neutral: return neutral(c);
    case Display::clip: break;
  }
  return c;
}

}  // namespace

void show(std::span<Colour> pixels, Display display, double exposure) {
  check_enumerator("display", display);
  check_range({"exposure", 0, limits::gain.most}, exposure);
  for (Colour& c : pixels) c = Colour(glm::clamp(shown(exposure * Radiance(c), display), 0.0, 1.0));
}

namespace {

// Without the dot.
std::string extension(const std::string& path, const PictureOptions& options) {
  if (!options.format.empty()) return options.format;
  return path == "-" ? "png" : extension_of(path);
}

// Of that file; null where it holds no picture.
const FileFormat* picture_format(const std::string& path, const PictureOptions& options) {
  const FileFormat* format = format_with_extension(extension(path, options));
  return format && format->can(FileFormat::picture) ? format : nullptr;
}

// Whole rows, and nothing but colours in them.
void check_picture(const std::string& path, int width, std::span<const Colour> pixels) {
  check_range(limits::picture_width, width);
  const auto across = std::size_t(width);
  if (pixels.empty() || pixels.size() % across != 0)
    throw UsageError(path, fmt::format("{} pixels are no rows of {}", pixels.size(), width));
  check_range(limits::picture_height, double(pixels.size() / across));
  const auto bad = [](const Colour& c) { return !(std::isfinite(c.x) && std::isfinite(c.y) && std::isfinite(c.z)); };
  const auto first = std::ranges::find_if(pixels, bad);
  if (first == pixels.end()) return;
  const auto place = std::size_t(first - pixels.begin());
  throw UsageError(path,
                   fmt::format("{} of {} pixels are NaN or infinite, the first at ({},{})",
                               std::ranges::count_if(pixels, bad), pixels.size(), place % across, place / across));
}

}  // namespace

bool is_picture(const std::string& path, const PictureOptions& options) {
  return picture_format(path, options) != nullptr;
}

bool is_linear_picture(const std::string& path, const PictureOptions& options) {
  const FileFormat* format = picture_format(path, options);
  return format && !is_integer(format->depths.front());
}

void write_picture(const std::string& path, int width, std::span<const Colour> pixels, const PictureOptions& options) {
  check_enumerator("display", options.display);
  check_picture(path, width, pixels);
  if (is_linear_picture(path, options)) return write_stored(path, width, pixels, Depth::single, options);
  std::vector<Colour> encoded(pixels.begin(), pixels.end());
  show(encoded, options.display);
  encode_srgb(encoded);
  write_stored(path, width, encoded, Depth::uint8, options);
}

void write_stored(const std::string& path, int width, std::span<const Colour> pixels, Depth depth,
                  const PictureOptions& options, const Attributes& attributes) {
  check_enumerator("depth", depth);
  check_picture(path, width, pixels);
  const int height = int(pixels.size() / std::size_t(width));
  OutputFile file(path, options.commit);
  const ImageWriter writer = make_writer(file, path, extension(path, options),
                                         {.levels = {{width, height}}, .depth = depth, .attributes = attributes});
  writer.write(0, 0, height, pixels);
  writer.close();
  file.commit();
}

}  // namespace envmap
