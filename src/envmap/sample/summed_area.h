/// @file
/// Boxes of any size at the price of four reads: summed-area tables (Crow 1984,
/// "Summed-area tables for texture mapping").
#pragma once

#include <vector>

#include "envmap/sample/padded_level.h"
#include "envmap/sample/sampler.h"
#include "envmap/sample/target_grid.h"

namespace envmap {

/// Sums of radiance x solid angle over all texels left of and above a place, for every face with a margin around it
/// that is filled through the projection.
/// Sums are doubles: behind a sun of 1e8 a float has no digits left for a sky of 1. They keep 1e-7 of the sky beside a
/// sun of 1e9.
class SummedArea {
 public:
  struct Entry {
    Rgb<double> light{0};
    double weight = 0;
    void add(const Entry& o) { light += o.light, weight += o.weight; }
  };

  /// @param margin texels around each face: half the largest box.
  SummedArea(const PaddedLevel& level, int margin);

  /// Solid-angle weighted mean over a box about a place; `half` are half its sides in texels, cut to the margin.
  [[nodiscard]] Colour mean(const Location<double>& at, Point2 half) const;

 private:
  void fill_face(const PaddedLevel& level, int face);
  [[nodiscard]] const Entry* entry(int face, int i, int j) const;
  void add_corner(int face, double x, double y, double sign, Entry& sum) const;

  int margin_, width_, height_;  // With the margin.
  std::vector<Entry> entries_;   // (width + 1) x (height + 1) a face, the first row and column 0.
};

/// Boxes that hold the footprint of each texel: seamless, never alias, blur what is oblique to the source's axes.
/// @param source must outlive the sampler.
Sampler summed_area_sampler(const PaddedLevel& source, const Target& target);

}  // namespace envmap
