/// @file
/// The environment map in memory: float32 linear RGB, faces and levels, each face with a gutter around it.
#pragma once

#include <cstddef>
#include <span>
#include <string_view>
#include <vector>

#include "envmap/map/storage.h"
#include "envmap/projection/projection.h"

namespace envmap {

/// One mip level: the faces of a projection at one size.
///
/// Rows are stored with `gutter` more texels at either end and above and below each face, so that a filter may read
/// that far over any edge. fill_gutter() (gutter.h) gives them their values.
class Level {
 public:
  /// Cubic taps reach 2 texels beyond a place, which settle.h may move out by 1.
  static constexpr int gutter = 3;

  /// All texels 0. @param size height of a face, at least 1. @param width of a face; 0: size x the aspect of the projection.
  /// Only the coarser levels of a latlong map have another: they halve each side and round it down, 90x45 45x22 ... 1x1.
  /// @param max_memory of the process, in bytes: the texels then lie in a scratch file (storage.h). 0: in memory.
  Level(Projection projection, int size, int width = 0, std::size_t max_memory = 0);

  [[nodiscard]] Projection projection() const { return projection_; }
  [[nodiscard]] int faces() const { return faces_; }
  [[nodiscard]] int width() const { return width_; }
  [[nodiscard]] int height() const { return height_; }

  /// Texel (i,j) of a face; i and j may reach `gutter` beyond the face.
  [[nodiscard]] Colour* texel(int face, int i, int j) { return pixels_.data() + index(face, i, j); }
  [[nodiscard]] const Colour* texel(int face, int i, int j) const { return pixels_.data() + index(face, i, j); }

  /// A row without its gutter.
  [[nodiscard]] std::span<Colour> row(int face, int j) { return {texel(face, 0, j), static_cast<std::size_t>(width_)}; }
  [[nodiscard]] std::span<const Colour> row(int face, int j) const {
    return {texel(face, 0, j), static_cast<std::size_t>(width_)};
  }

  /// The limit that the texels were made with, and what holds to it: to be called while many of them are gone through.
  [[nodiscard]] std::size_t max_memory() const { return pixels_.limit(); }
  void trim() const { pixels_.trim(); }

  /// Texels from one row to the next.
  [[nodiscard]] std::ptrdiff_t stride() const { return width_ + 2 * gutter; }

 private:
  [[nodiscard]] std::size_t index(int face, int i, int j) const {
    return static_cast<std::size_t>((static_cast<std::ptrdiff_t>(face) * (height_ + 2 * gutter) + j + gutter) * stride() +
                                    i + gutter);
  }

  Projection projection_;
  int faces_, width_, height_;
  Storage pixels_;  // One more than there are texels: vector code loads four floats at a time.
};

/// The world axis at the centre of latlong and angular images; the other projections always show +Z there.
enum class Forward { plus_z, minus_z, plus_x, minus_x };

inline constexpr std::string_view forward_names[] = {"+z", "-z", "+x", "-x"};

/// Turn about +Y from the image frame (+Z at the centre) to the world.
Rotation image_to_world(Forward forward);

/// Whether the projection has a centre that --forward can choose.
inline bool has_forward(Projection p) { return p == Projection::latlong || p == Projection::angular; }

/// A whole environment: level 0 and what mip levels there are.
struct EnvironmentMap {
  std::vector<Level> levels;
  Forward forward = Forward::plus_z;

  [[nodiscard]] const Level& base() const { return levels.front(); }
  [[nodiscard]] Level& base() { return levels.front(); }
  [[nodiscard]] Projection projection() const { return base().projection(); }
};

}  // namespace envmap
