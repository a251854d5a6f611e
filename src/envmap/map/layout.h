/// @file
/// Where the faces of a map lie in one image: cube columns, rows and crosses, the two halves of a paraboloid map.
#pragma once

#include <optional>
#include <span>
#include <string_view>

#include "envmap/base/enumerators.h"
#include "envmap/base/export.h"
#include "envmap/projection/projection.h"

namespace ENVMAP_EXPORT envmap {

/// `single` for one face, `pair` for the two halves of a paraboloid map, the rest for cubes; `files` is one file a
/// face, `api` a cube texture of KTX, KTX2 and DDS. Its faces are mirrored against those in memory: +X, -X, +Z and -Z
/// left to right, +Y and -Y top to bottom.
enum class Layout { single, pair, column, row, cross, vcross, grid3x2, files, api };
template <>
inline constexpr std::size_t enumerators<Layout> = std::size_t(Layout::api) + 1;

inline constexpr Layout cube_layouts[] = {Layout::column, Layout::row,     Layout::cross,
                                          Layout::vcross, Layout::grid3x2, Layout::files};

std::string_view name(Layout layout);
std::optional<Layout> layout_named(std::string_view name);

/// Names of the faces in file names, in the order +X -X +Y -Y +Z -Z.
inline constexpr std::string_view cube_face_names[] = {"px", "nx", "py", "ny", "pz", "nz"};

/// A face's place, in faces from the left and from the top. `turned`: by half a turn (the +Z face of a vertical cross).
struct Slot {
  int column, row;
  bool turned = false;
};
struct Grid {
  int columns, rows;
  std::span<const Slot> slots;  ///< In face order.
};
Grid grid(Layout layout);

/// The layout a projection has when none is asked for.
Layout default_layout(Projection p);

}  // namespace envmap
