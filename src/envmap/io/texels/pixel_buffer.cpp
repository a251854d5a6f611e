#include "envmap/io/texels/pixel_buffer.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <span>
#include <vector>

#include "envmap/base/error.h"
#include "envmap/base/parallel.h"
#include "envmap/base/run_operation.h"
#include "envmap/io/claims/srgb.h"
#include "envmap/io/images/detect_layout.h"
#include "envmap/io/texels/texels.h"
#include "envmap/io/texels/value_range.h"
#include "envmap/map/atlas.h"

namespace envmap {
namespace {

constexpr int band_rows = 64;
constexpr std::array<std::ptrdiff_t, 4> channel_bytes{4, 2, 1, 2};
constexpr std::array depth_of_channel{Depth::single, Depth::half, Depth::uint8, Depth::uint16};

bool is_float(ChannelType type) { return type == ChannelType::float32 || type == ChannelType::float16; }

// A buffer whose strides are all said.
template <class Byte>
BasicPixelBuffer<Byte> checked(BasicPixelBuffer<Byte> b) {
  const std::ptrdiff_t channel = channel_bytes[number_of("type", b.type)];
  if (b.transfer) check_enumerator("transfer", *b.transfer);
  if (!b.pixels) throw UsageError("pixels must not be null");
  check_range(limits::picture_width, b.width);
  check_range({"height", limits::picture_width.least, limits::picture_width.most}, b.height);
  if (b.channels != 1 && b.channels != 3 && b.channels != 4)
    throw UsageError(fmt::format("channels must be 1, 3 or 4, not {}", b.channels));
  if (!is_float(b.type) && !b.transfer)
    throw UsageError("integers must say their transfer, linear or srgb: they are no radiance by themselves");
  const std::ptrdiff_t pixel = b.channels * channel;
  if (b.pixel_stride == 0) b.pixel_stride = pixel;
  if (b.pixel_stride < pixel || b.pixel_stride % channel != 0)
    throw UsageError(
        fmt::format("pixel_stride must be a multiple of {} and at least {}, not {}", channel, pixel, b.pixel_stride));
  const std::ptrdiff_t row = (b.width - 1) * b.pixel_stride + pixel;
  if (b.row_stride == 0) b.row_stride = b.width * b.pixel_stride;
  if (std::abs(b.row_stride) < row || b.row_stride % channel != 0)
    throw UsageError(fmt::format("row_stride must be a multiple of {}, and at least {} or at most -{}, not {}", channel,
                                 row, row, b.row_stride));
  return b;
}

template <class Byte>
Byte* row_of(const BasicPixelBuffer<Byte>& b, int row) {
  return b.pixels + row * b.row_stride;
}

// The channels of a row, one value after another. @param count channels of a pixel that are wanted.
template <class T>
void gather_channels(const PixelBuffer& b, const std::byte* row, int count, std::span<T> out) {
  const std::size_t bytes = std::size_t(count) * sizeof(T);
  if (std::size_t(b.pixel_stride) == bytes) {
    std::memcpy(out.data(), row, out.size_bytes());
    return;
  }
  for (int i = 0; i < b.width; ++i) std::memcpy(&out[std::size_t(i * count)], row + i * b.pixel_stride, bytes);
}

void load_floats(const PixelBuffer& b, const std::byte* row, int count, std::span<float> out) {
  switch (b.type) {
    case ChannelType::float32: gather_channels(b, row, count, out); break;
    case ChannelType::float16: {
      std::vector<std::uint16_t> halves(out.size());
      gather_channels<std::uint16_t>(b, row, count, halves);
      from_half(halves, out);
      break;
    }
    case ChannelType::uint8: {
      std::vector<std::uint8_t> values(out.size());
      gather_channels<std::uint8_t>(b, row, count, values);
      std::ranges::transform(values, out.begin(), [](std::uint8_t v) { return float(v) / 255; });
      break;
    }
    case ChannelType::uint16: {
      std::vector<std::uint16_t> values(out.size());
      gather_channels<std::uint16_t>(b, row, count, values);
      std::ranges::transform(values, out.begin(), [](std::uint16_t v) { return float(v) / 65535; });
      break;
    }
  }
}

void load_row(const PixelBuffer& b, int row, std::span<Colour> out) {
  const int count = std::min(b.channels, 3);
  const std::span<float> floats(&out.data()->x, 3 * out.size());
  if (count == 3) {
    load_floats(b, row_of(b, row), count, floats);
  } else {  // Grey values come into the last third, and are spread from the first on.
    const std::span<float> grey = floats.last(out.size());
    load_floats(b, row_of(b, row), count, grey);
    for (std::size_t k = 0; k < out.size(); ++k) out[k] = Colour(grey[k]);
  }
  if (b.transfer == Transfer::srgb) decode_srgb(out);
}

template <class T>
void scatter_channels(const MutablePixelBuffer& b, std::byte* row, std::span<const T> values, T opaque) {
  for (int i = 0; i < b.width; ++i) {
    std::byte* const pixel = row + i * b.pixel_stride;
    std::memcpy(pixel, &values[std::size_t(3 * i)], std::size_t(std::min(b.channels, 3)) * sizeof(T));
    if (b.channels == 4) std::memcpy(pixel + 3 * sizeof(T), &opaque, sizeof(T));
  }
}

template <class T>
void scatter_integers(const MutablePixelBuffer& b, std::byte* row, std::span<const float> values) {
  constexpr auto most = float(T(-1));
  std::vector<T> out(values.size());
  std::ranges::transform(values, out.begin(), [](float v) { return T(std::clamp(v, 0.0F, 1.0F) * most + 0.5F); });
  scatter_channels<T>(b, row, out, T(-1));
}

void store_row(const MutablePixelBuffer& b, int row, std::span<Colour> texels) {
  if (b.transfer == Transfer::srgb) encode_srgb(texels);
  const std::span<const float> values(&texels.data()->x, 3 * texels.size());
  std::byte* const to = row_of(b, row);
  switch (b.type) {
    case ChannelType::float32: scatter_channels(b, to, values, 1.0F); break;
    case ChannelType::float16: {
      std::vector<std::uint16_t> halves(values.size());
      to_half(values, halves);
      scatter_channels<std::uint16_t>(b, to, halves, 0x3c00);
      break;
    }
    case ChannelType::uint8: scatter_integers<std::uint8_t>(b, to, values); break;
    case ChannelType::uint16: scatter_integers<std::uint16_t>(b, to, values); break;
  }
}

DetectedLayout layout_of(const PixelBuffer& b, const BufferLayout& how) {
  Metadata said;
  said.projection = how.projection, said.layout = how.layout;
  return detect_layout(b.width, b.height, said, {});
}

}  // namespace

EnvironmentMap map_of(const PixelBuffer& buffer, const BufferLayout& layout, const Run& run) {
  const PixelBuffer b = checked(buffer);
  const DetectedLayout found = layout_of(b, layout);
  return run_operation(run, [&](const Progress& progress) {
    EnvironmentMap map = blank_map({found.projection, layout.forward}, found.size);
    Level& level = map.base();
    if (found.layout == Layout::single) {  // Rows of the image are those of the face.
      for_each_row(1, b.height, progress, [&](int, int row) { load_row(b, row, level.row(0, row)); });
      return map;
    }
    const Grid places = grid(found.layout);
    for (int begin = 0; begin < b.height; begin += band_rows) {
      const int end = std::min(begin + band_rows, b.height);
      const auto width = std::size_t(b.width);
      std::vector<Colour> band(std::size_t(end - begin) * width);
      parallel_for(end - begin,
                   [&](int k) { load_row(b, begin + k, std::span(band).subspan(std::size_t(k) * width, width)); });
      scatter(band, b.width, begin, end, places, level);
      if (progress) progress(double(end) / b.height);
    }
    return map;
  });
}

void copy_to(const EnvironmentMap& map, const MutablePixelBuffer& buffer, const CopyOptions& options, const Run& run) {
  const MutablePixelBuffer b = checked(buffer);
  check_range({"level", 0, double(map.levels.size()) - 1}, options.level);
  if (options.layout) check_enumerator("layout", *options.layout);
  const Level& level = map.levels[std::size_t(options.level)];
  if (options.layout &&
      (level.projection() != Projection::cube || *options.layout >= Layout::files || *options.layout < Layout::column))
    throw UsageError("a layout is column, row, cross, vcross or grid3x2, of a cube map");
  if (b.channels == 1) throw UsageError("channels must be 3 or 4, not 1: a map has colours");
  const Rows rows = rows_of(level, map.forward);
  const ClampedRows limited(rows, range_of(depth_of_channel[std::size_t(b.type)], std::numeric_limits<float>::max()),
                            true);
  const Rows shown = limited.rows();
  const Atlas atlas{shown, grid(options.layout.value_or(default_layout(level.projection())))};
  if (b.width != atlas.width() || b.height != atlas.height())
    throw UsageError(
        fmt::format("the image must be {}x{}, not {}x{}", atlas.width(), atlas.height(), b.width, b.height));
  run_operation(run, [&](const Progress& progress) {
    for (int begin = 0; begin < b.height; begin += band_rows) {
      const int end = std::min(begin + band_rows, b.height);
      const auto width = std::size_t(b.width);
      std::vector<Colour> band(std::size_t(end - begin) * width);
      atlas.gather(begin, end, band);
      parallel_for(end - begin,
                   [&](int k) { store_row(b, begin + k, std::span(band).subspan(std::size_t(k) * width, width)); });
      if (progress) progress(double(end) / b.height);
    }
  });
  const ClampStatistics lost = limited.total();
  if (lost.nan > 0) throw UsageError(fmt::format("{} texels are NaN", lost.nan), Remedy::repair);
  if (lost.over + lost.negative > 0 && !options.clamp)
    throw UsageError(fmt::format("{} texels are beyond what the channels hold: take float32",
                                 lost.over + lost.negative),
                     Remedy::clamp_or_dim);
}

}  // namespace envmap
