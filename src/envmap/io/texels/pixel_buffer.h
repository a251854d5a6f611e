/// @file
/// Images in the caller's memory: maps are made of them, and copied into them, with any strides.
#pragma once

#include <cstddef>
#include <optional>

#include "envmap/base/enumerators.h"
#include "envmap/base/export.h"
#include "envmap/base/run.h"
#include "envmap/map/environment_map.h"
#include "envmap/map/layout.h"

namespace ENVMAP_EXPORT envmap {

/// A channel of a pixel in memory, in the byte order of the machine.
enum class ChannelType { float32, float16, uint8, uint16 };
template <>
inline constexpr std::size_t enumerators<ChannelType> = std::size_t(ChannelType::uint16) + 1;

/// What stored values stand for: linear light, or the curve of sRGB (IEC 61966-2-1). Integers are 0 to 1.
enum class Transfer { linear, srgb };
template <>
inline constexpr std::size_t enumerators<Transfer> = std::size_t(Transfer::srgb) + 1;

/// An image whose memory belongs to the caller. @tparam Byte const std::byte, or std::byte to write.
template <class Byte>
struct BasicPixelBuffer {
  Byte* pixels = nullptr;  ///< The first channel of the upper left pixel.
  int width = 0, height = 0;
  int channels = 3;  ///< Of a pixel: 1 is grey, 3 is R, G and B, 4 has alpha, which is not read and is written as 1.
  ChannelType type = ChannelType::float32;
  /// Bytes from a pixel to the next, and from a row to the next below it: negative where the first row in memory is the
  /// lowest. 0: no gaps.
  std::ptrdiff_t pixel_stride = 0, row_stride = 0;
  std::optional<Transfer> transfer = {};  ///< Integers must say theirs; of floats absent is linear.
};
using PixelBuffer = BasicPixelBuffer<const std::byte>;
using MutablePixelBuffer = BasicPixelBuffer<std::byte>;

/// Which map an image holds.
struct BufferLayout {
  /// Absent: by the shape of the image, as read() has it: 2:1 is latlong, 1:6, 6:1, 4:3, 3:4 and 3:2 are cubes.
  std::optional<Projection> projection = {};
  std::optional<Layout> layout = {};  ///< Of a cube; absent: by the shape.
  Forward forward = Forward::plus_z;
};

/// Copies an image into a map of one level. Values are kept as they are: operations refuse NaN and infinity, and
/// repair() replaces them.
/// @throws UsageError where the buffer is null, its strides overlap, or integers do not say their transfer, InputError
/// where no map has that shape.
EnvironmentMap map_of(const PixelBuffer& buffer, const BufferLayout& layout = {}, const Run& run = {});

struct CopyOptions {
  int level = 0;
  std::optional<Layout> layout = {};  ///< Of a cube; absent: column.
  bool clamp = false;                 ///< Clamps values that the channels cannot hold. Without it they are refused.
};

/// Copies a level of a map into an image of the caller, which must be as large as its layout.
/// @throws UsageError as map_of(), where the image has another size, or where values do not fit and `clamp` is not set.
void copy_to(const EnvironmentMap& map, const MutablePixelBuffer& buffer, const CopyOptions& options = {},
             const Run& run = {});

}  // namespace envmap
