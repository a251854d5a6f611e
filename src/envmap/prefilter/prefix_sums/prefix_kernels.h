/// @file
/// The inner loops of the sums at the horizon, many cells at a time.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "envmap/prefilter/prefix_sums/prefix_source.h"
#include "envmap/prefilter/prefix_sums/prefix_sums.h"

namespace envmap::prefiltering {

/// Cells that a horizon may cut: their fields, and the fields that bound_cells() derives. Arrays by cell, with room for
/// a vector more.
class CellBatch {
 public:
  enum Field {
    middle,
    across,
    down,
    bend,
    mean,
    near,
    far,
    solid_angle,
    weight1,
    variation1,
    weight2,
    variation2,
    fields
  };
  /// Range of t; high / (high - low); weight / t at `high`; the integral of the weight over the cell and its error;
  /// solid angle and mean t as floats.
  enum Derived { low, high, slope, steep, uniform, error, omega, average, derived_fields };
  struct Place {
    const CellLight* light;
    int face, row, column;
  };

  [[nodiscard]] std::size_t count() const { return count_; }
  [[nodiscard]] double* field(Field f) { return &fields_[std::size_t(f) * room_]; }
  [[nodiscard]] float* derived(Derived f) { return &derived_[std::size_t(f) * room_]; }
  [[nodiscard]] const Place& place(std::size_t k) const { return places_[k]; }

  void clear() { count_ = 0; }
  void add(const CellView& view, const CellShape& shape, double solid, const Place& at) {
    if (count_ == places_.size()) grow();
    double* p = &fields_[count_];
    for (const double x : {view.middle, view.across, view.down, view.bend, view.uniform, shape.near, shape.far, solid,
                           shape.weight1, shape.variation1, shape.weight2, shape.variation2})
      *p = x, p += room_;
    places_[count_++] = at;
  }

 private:
  void grow();

  std::size_t count_ = 0, room_ = 0;  // Room for a vector more than there are places.
  std::vector<double> fields_;
  std::vector<float> derived_;
  std::vector<Place> places_;
};

/// The sum over a cell of light x weight, lanes red, green, blue: middle +- error.
struct CellTerm {
  CellTerm() {}  // NOLINT: arrays of many terms are not set to 0.
  alignas(16) float middle[4], error[4];
  int face, row, column;
};

/// Derives the fields of a batch, and appends the terms of all cells that reach above the horizon.
void bound_cells(const FaceDirection& n, const ClampedCosinePolynomial& weight, CellBatch& batch,
                 std::vector<CellTerm>& out);

/// For each y, half the range of longitudes, in [0, pi], over which z y + level cos(longitude) > 0.
/// @param slope z / level.
void border_angles(double slope, std::span<const double> y, std::vector<double>& angles);

}  // namespace envmap::prefiltering
