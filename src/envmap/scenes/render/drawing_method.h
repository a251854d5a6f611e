/// @file
/// The ways of drawing a map, and which of them is the cheapest that is exact.
#pragma once

#include <cstddef>
#include <iterator>
#include <string_view>

#include "envmap/base/enumerators.h"
#include "envmap/base/export.h"
#include "envmap/projection/projection.h"

namespace ENVMAP_EXPORT envmap {

/// exact: each texel's ray meets the triangles themselves. distort: vertices moved by the map's formula, sides
/// straight.
/// tessellate: the same, cut until the sides bend within a quarter of a pixel. resample: six faces of a cube, and the
/// bilinear filter of convert(). raycast: a tree of boxes (raycast.h), no OpenGL.
enum class DrawMethod { automatic, exact, distort, tessellate, resample, raycast };
inline constexpr std::string_view draw_method_names[] = {"auto",       "exact",    "distort",
                                                         "tessellate", "resample", "raycast"};
template <>
inline constexpr std::size_t enumerators<DrawMethod> = std::size(draw_method_names);

/// What OpenGL draws with. automatic: a graphics card through EGL, else OSMesa, else the processor through EGL.
enum class ContextKind { automatic, osmesa, egl };
inline constexpr std::string_view context_names[] = {"auto", "osmesa", "egl"};
template <>
inline constexpr std::size_t enumerators<ContextKind> = std::size(context_names);

/// How mirrors look their maps up. direction: as if all in them were far away. distance: where the ray meets what the
/// map shows. vertex: by direction, at vertices, places in the map interpolated between them, as was done before 2000.
enum class MirrorLookup { direction, distance, vertex };
inline constexpr std::string_view mirror_lookup_names[] = {"direction", "distance", "vertex"};
template <>
inline constexpr std::size_t enumerators<MirrorLookup> = std::size(mirror_lookup_names);

/// How rough surfaces reflect the environment. split_sum: one lookup of a level that is prefiltered for a view from
/// straight above. sampled: samples of the lobe as it is seen (sampled_reflection.h).
enum class Reflection { split_sum, sampled };
inline constexpr std::string_view reflection_names[] = {"split-sum", "sampled"};
template <>
inline constexpr std::size_t enumerators<Reflection> = std::size(reflection_names);

}  // namespace envmap
