#include "envmap/base/costs.h"

namespace envmap {
namespace {

// Processor time of all threads on an x86-64 server with AVX2, by `envmap tradeoff --calibrate`, which says in
// tools/tradeoff/calibrate.cpp what it times.
constexpr std::array<CostFact, cost_count> facts{{
    // The order in which filters are tried where an error is asked for.
    {"filter nearest", "a texel of a map 4 times as coarse as its source", 30},
    {"filter bilinear", "the same", 31},
    {"filter bicubic", "the same", 120},
    {"filter bilinear 2", "the same, 2 x 2 samples", 85},
    {"filter bilinear 4", "the same, 4 x 4 samples", 250},
    {"filter ewa", "the same", 1100},
    {"filter bilinear 8", "the same, 8 x 8 samples", 900},
    {"filter area", "the same, to 1e-4", 4200},
    // How the map of a scene is drawn.
    {"draw texel", "a texel drawn in its own projection", 170},
    {"draw triangle", "a triangle, for each face that it is sent to", 1200},
    {"cube texel", "a texel of a cube that is drawn to be resampled", 100},
    {"cube triangle", "a triangle in all of that cube", 1000},
    {"resample texel", "a texel resampled from that cube", 100},
    {"ray texel", "a texel that a ray is cast for", 310},
    {"ray triangle", "a triangle in the tree that rays are cast through", 800},
}};

}  // namespace

std::span<const CostFact, cost_count> cost_facts() { return facts; }

Costs::Costs() {
  for (std::size_t k = 0; k < cost_count; ++k) nanoseconds[k] = facts[k].nanoseconds;
}

}  // namespace envmap
