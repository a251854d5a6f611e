/// @file
/// What automatic choices of a method rest on: processor times, of which only ratios matter.
/// No figure here decides what is right.
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <string_view>

#include "envmap/base/export.h"

namespace ENVMAP_EXPORT envmap {

enum class Cost {
  nearest,
  bilinear,
  bicubic,
  bilinear_2,
  bilinear_4,
  ewa,
  bilinear_8,
  area,
  draw_texel,
  draw_triangle,
  cube_texel,
  cube_triangle,
  resample_texel,
  ray_texel,
  ray_triangle,
};
inline constexpr std::size_t cost_count = std::size_t(Cost::ray_triangle) + 1;

struct CostFact {
  std::string_view name, what;
  double nanoseconds;
};

/// In the order of Cost, with the figures that are taken unless others are given: costs.cpp.
std::span<const CostFact, cost_count> cost_facts();

/// Nanoseconds of each.
struct Costs {
  std::array<double, cost_count> nanoseconds;

  Costs();
  double operator[](Cost c) const { return nanoseconds[std::size_t(c)]; }
  double& operator[](Cost c) { return nanoseconds[std::size_t(c)]; }
};

}  // namespace envmap
