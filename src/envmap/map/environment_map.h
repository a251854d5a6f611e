/// @file
/// The environment map in memory: float32 linear RGB, faces and levels.
#pragma once

#include <cassert>
#include <cstddef>
#include <iterator>
#include <memory>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

#include "envmap/base/enumerators.h"
#include "envmap/base/export.h"
#include "envmap/map/storage.h"
#include "envmap/projection/projection.h"

namespace ENVMAP_EXPORT envmap {

/// One mip level: the faces of a projection at one size.
///
/// Levels are moved, or copied by clone(), never by accident. Faces are stored with room for an apron of texels around
/// them, which only a PaddedLevel (sample/padded_level.h) fills and reads.
class Level {
 public:
  /// Cubic taps reach 2 texels beyond a place, which the inverse bilinear lookup may move out by 1.
  static constexpr int padding = 3;

  /// All texels 0. @param size height of a face, at least 1. @param width of a face; 0: size x the aspect of the
  /// projection. Only the coarser levels of a latlong map have another: they halve each side and round it down, 90x45
  /// 45x22 ... 1x1.
  /// @param max_memory of the process, in bytes: the texels then lie in a scratch file (storage.h). 0: in memory.
  /// @throws UsageError where a side is out of its range (bounds.h) or the width of another map than a latlong one is
  /// not that of its projection, std::bad_alloc.
  Level(Projection projection, int size, int width = 0, std::size_t max_memory = 0);
  /// A level that was moved from is empty: it has no faces and no rows.
  Level(Level&& from) noexcept
      : projection_(from.projection_),
        faces_(std::exchange(from.faces_, 0)),
        width_(std::exchange(from.width_, 0)),
        height_(std::exchange(from.height_, 0)),
        pixels_(std::move(from.pixels_)) {}
  Level& operator=(Level&& from) noexcept {
    if (this == &from) return *this;
    projection_ = from.projection_;
    faces_ = std::exchange(from.faces_, 0), width_ = std::exchange(from.width_, 0);
    height_ = std::exchange(from.height_, 0);
    pixels_ = std::move(from.pixels_);
    return *this;
  }
  [[nodiscard]] Level clone() const { return Level(*this); }

  [[nodiscard]] Projection projection() const { return projection_; }
  [[nodiscard]] int faces() const { return faces_; }
  [[nodiscard]] int width() const { return width_; }
  [[nodiscard]] int height() const { return height_; }

  /// Texel (i,j) of a face.
  [[nodiscard]] Colour* texel(int face, int i, int j) {
    assert(i >= 0 && i < width_ && j >= 0 && j < height_);
    return stored(face, i, j);
  }
  [[nodiscard]] const Colour* texel(int face, int i, int j) const {
    assert(i >= 0 && i < width_ && j >= 0 && j < height_);
    return stored(face, i, j);
  }

  [[nodiscard]] std::span<Colour> row(int face, int j) { return {texel(face, 0, j), std::size_t(width_)}; }
  [[nodiscard]] std::span<const Colour> row(int face, int j) const { return {texel(face, 0, j), std::size_t(width_)}; }

  /// Those of a row that hold the map: all, but for rows of a disc.
  [[nodiscard]] Columns columns(int j) const {
    return on_disc(projection_) ? envmap::columns(projection_, height_, j) : Columns{0, width_};
  }
  /// Those of a row that carry solid angle: corners beside a disc do not, also where they are filled.
  [[nodiscard]] Columns weighted_columns(int j) const {
    return on_disc(projection_) ? disc_columns(height_, j) : Columns{0, width_};
  }

  /// The limit that the texels were made with, and what holds to it: to be called while many of them are gone through.
  [[nodiscard]] std::size_t max_memory() const { return pixels_.limit(); }
  void trim() const { pixels_.trim(); }

  /// Texels from one row to the next.
  [[nodiscard]] std::ptrdiff_t stride() const { return width_ + 2 * padding; }

 private:
  friend class PaddedLevel;
  Level(const Level&) = default;
  // Texel (i,j), of the apron, too.
  [[nodiscard]] Colour* stored(int face, int i, int j) { return pixels_.data() + index(face, i, j); }
  [[nodiscard]] const Colour* stored(int face, int i, int j) const { return pixels_.data() + index(face, i, j); }

  [[nodiscard]] std::size_t index(int face, int i, int j) const {
    return std::size_t((std::ptrdiff_t(face) * (height_ + 2 * padding) + j + padding) * stride() + i + padding);
  }

  Projection projection_;
  int faces_, width_, height_;
  Storage pixels_;  // One more than there are texels: vector code loads four floats at a time.
};

/// The world axis at the centre of latlong and angular images; the other projections always show +Z there.
enum class Forward { plus_z, minus_z, plus_x, minus_x };

inline constexpr std::string_view forward_names[] = {"+z", "-z", "+x", "-x"};
template <>
inline constexpr std::size_t enumerators<Forward> = std::size(forward_names);

/// Turn about +Y from the image frame (+Z at the centre) to the world.
Rotation image_to_world(Forward forward);

/// A world axis whose two directions are exchanged, as left-handed tools need it.
enum class MirroredAxis { none, x, y, z };
inline constexpr std::string_view mirrored_axis_names[] = {"none", "x", "y", "z"};
template <>
inline constexpr std::size_t enumerators<MirroredAxis> = std::size(mirrored_axis_names);

/// How an image shows the world: its projection, and the world axis at its centre.
struct Frame {
  Projection projection;
  Forward forward;  ///< +z for projections without a centre to choose, whatever was asked for.

  Frame(Projection p, Forward f = Forward::plus_z)  // NOLINT: a projection is a frame.
      : projection(p), forward(has_forward(p) ? f : Forward::plus_z) {
    check_enumerator("forward", f);
  }
};

/// A member that makes its owner movable but not copyable, and leaves it an aggregate.
struct MoveOnly {
  MoveOnly() = default;
  MoveOnly(MoveOnly&&) = default;
  MoveOnly& operator=(MoveOnly&&) = default;
};

/// A whole environment: level 0 and what mip levels there are. It is moved, or copied by clone().
///
/// In memory the faces of a cube are seen from inside. The faces of a cube texture of OpenGL, Vulkan and Direct3D are
/// mirrored against them: +X, -X, +Z and -Z left to right, +Y and -Y top to bottom. pack() returns those.
///
/// Operations refuse a map that holds NaN or infinity, with InputError. repair() replaces those texels. find_flaws(),
/// measure() and irradiance() leave them out. Negative values are summed like others.
struct EnvironmentMap {
  std::vector<Level> levels = {};
  Forward forward = Forward::plus_z;
  [[no_unique_address]] MoveOnly move_only = {};

  [[nodiscard]] EnvironmentMap clone() const;

  /// Level 0. @throws UsageError where there is none.
  [[nodiscard]] const Level& base() const { return levels.empty() ? no_level() : levels.front(); }
  [[nodiscard]] Level& base() { return levels.empty() ? no_level() : levels.front(); }
  [[nodiscard]] Projection projection() const { return base().projection(); }
  [[nodiscard]] Frame frame() const { return {projection(), forward}; }

 private:
  [[noreturn]] static Level& no_level();
};

/// A pointer that does not own the map: where a map is shared, it stands for one that outlives all use of it.
inline std::shared_ptr<const EnvironmentMap> borrowed(const EnvironmentMap& map) {
  return {std::shared_ptr<const EnvironmentMap>(), &map};
}

/// @throws UsageError where the levels are no mip chain as write() and pack() take them: one projection, each level
/// half the one before, rounded down, and none after that of one texel.
void check_levels(const EnvironmentMap& map);

/// A map of one level, all 0.
EnvironmentMap blank_map(const Frame& frame, int size);

}  // namespace envmap
