/// @file
/// The inner loops of the sums at the horizon, many cells at a time.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "envmap/prefilter/prefix_sums/prefix_source.h"
#include "envmap/prefilter/prefix_sums/prefix_sums.h"

namespace envmap::prefiltering {

/// Cells that a horizon may cut, and what it makes of them. Arrays by cell, with room for a vector more.
class HingeBatch {
 public:
  enum Field { middle, across, down, bend, mean, near, far, solid_angle, weight1, uneven1, weight2, uneven2, fields };
  /// Range of t, high / (high - low), weight / t at `high`, what even light of radiance 1 adds, and two fields once
  /// more.
  enum Found { low, high, slope, steep, even, off, omega, average, founds };
  struct Place {
    const HingeCell* light;
    int face, row, column;
  };

  [[nodiscard]] std::size_t count() const { return count_; }
  [[nodiscard]] double* field(Field f) { return &fields_[std::size_t(f) * room_]; }
  [[nodiscard]] float* found(Found f) { return &found_[std::size_t(f) * room_]; }
  [[nodiscard]] const Place& place(std::size_t k) const { return places_[k]; }

  void clear() { count_ = 0; }
  void add(const CellView& view, const CellShape& shape, double solid, const Place& at) {
    if (count_ == places_.size()) grow();
    double* p = &fields_[count_];
    for (const double x : {view.middle, view.across, view.down, view.bend, view.even, shape.near, shape.far, solid,
                           shape.weight1, shape.uneven1, shape.weight2, shape.uneven2})
      *p = x, p += room_;
    places_[count_++] = at;
  }

 private:
  void grow();

  std::size_t count_ = 0, room_ = 0;  // Room for a vector more than there are places.
  std::vector<double> fields_;
  std::vector<float> found_;
  std::vector<Place> places_;
};

/// The sum over a cell of light x weight, lanes red, green, blue: `middle` within `off`.
struct HingeTerm {
  HingeTerm() {}  // NOLINT: not set, as they are many.
  alignas(16) float middle[4], off[4];
  int face, row, column;
};

/// Sets what is found of a batch, and appends the terms of all its cells with light above the horizon.
void bound_cells(const FaceDirection& n, const HingePolynomial& weight, HingeBatch& batch, std::vector<HingeTerm>& out);

/// Half the longitudes, in [0, pi], over which z y + level cos(longitude) > 0, for each y. @param slope z / level.
void border_angles(double slope, std::span<const double> y, std::vector<double>& angles);

}  // namespace envmap::prefiltering
