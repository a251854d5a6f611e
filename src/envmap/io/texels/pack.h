/// @file
/// A map as the bytes of a texture, ready for upload.
#pragma once

#include <cstddef>
#include <iterator>
#include <span>
#include <string_view>
#include <vector>

#include "envmap/base/enumerators.h"
#include "envmap/base/export.h"
#include "envmap/base/run.h"
#include "envmap/map/environment_map.h"

namespace ENVMAP_EXPORT envmap {

/// Texels in memory order, little-endian. Alpha is 1. bc6h is BC6H_UF16 in blocks of 4 x 4 texels.
enum class PixelFormat { rgba16f, rgba32f, rgb16f, rgb32f, rgb9e5, bc6h };
inline constexpr std::string_view pixel_format_names[] = {"rgba16f", "rgba32f", "rgb16f", "rgb32f", "rgb9e5", "bc6h"};
template <>
inline constexpr std::size_t enumerators<PixelFormat> = std::size(pixel_format_names);

/// How the faces of a cube lie:
/// - graphics_api: as OpenGL, Vulkan and Direct3D define a cube texture. A lookup with world direction d returns
///   the radiance from d.
/// - seen_from_inside: as in EnvironmentMap.
/// Maps of other projections are the same in both. Their first row is v = 0, the top of the image, in all three APIs.
enum class FaceOrientation { graphics_api, seen_from_inside };
template <>
inline constexpr std::size_t enumerators<FaceOrientation> = std::size_t(FaceOrientation::seen_from_inside) + 1;

struct PackOptions {
  PixelFormat format = PixelFormat::rgba16f;
  FaceOrientation orientation = FaceOrientation::graphics_api;
  bool clamp = false;  ///< Clamps values beyond what the format holds. Without it they are refused.
  /// Rows of texels or blocks start at multiples of so many bytes, 1 to 4096: 256 for Direct3D 12.
  int row_alignment = 1;
};

/// All levels of a map: level by level, in each the faces +X -X +Y -Y +Z -Z, in each the rows from the top.
struct PackedMap {
  /// One face of one level.
  struct Part {
    std::size_t offset = 0, size = 0;  ///< In `bytes`.
    int width = 0, height = 0;         ///< In texels.
    std::size_t row_bytes = 0;         ///< From one row of texels, or of blocks, to the next.
  };

  PixelFormat format = PixelFormat::rgba16f;
  int faces = 1, levels = 0;
  std::vector<std::byte> bytes = {};
  std::vector<Part> parts = {};  ///< `levels` x `faces`, face by face in each level.
  double flux_lost = 0;          ///< Part of a level's flux that clamping took; of several levels, the largest.

  /// @throws UsageError where there is no such level or face.
  [[nodiscard]] const Part& part(int level, int face) const;
  /// The bytes of a level with all of its faces, which lie one after another: one copy of Vulkan or Direct3D.
  /// @throws UsageError where there is no such level.
  [[nodiscard]] std::span<const std::byte> level(int level) const;
};

/// @throws InputError where a texel is NaN or infinite, UsageError where a texel is negative and the format has no
/// sign, where values do not fit and `clamp` is not set, where an option is out of its range, or where levels are not
/// the halves of the ones before, as write() wants them, too.
PackedMap pack(const EnvironmentMap& map, const PackOptions& options = {}, const Run& run = {});

}  // namespace envmap
