/// @file
/// Counters of the steps that methods take. They are the same on every machine and for any number of threads, so that a
/// test can check the cost of a map without a clock.
#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <string_view>

namespace envmap::prefiltering {

enum class Work {
  kernels,            ///< Values of a kernel at nodes of grids.
  taps,               ///< Nodes times a kernel value that is shared.
  nodes,              ///< Interpolations of a grid.
  near_field_points,  ///< Values of a kernel at points of texels.
  horizon_rows,       ///< Rows of cells above a horizon.
  horizon_cells,      ///< Cells that a horizon cuts.
  horizon_parts,      ///< Texels that a horizon cuts, and parts of them.
  bounded_nodes,      ///< Nodes of a tree whose bounds were computed.
  node_sums,          ///< Nodes times directions.
  sheen,              ///< Texels along a horizon of sheen, and points of blocks.
  exact,              ///< Texels times directions that were summed exactly.
};
inline constexpr std::string_view work_names[] = {"kernels",      "taps",          "nodes",         "near_field_points",
                                                  "horizon_rows", "horizon_cells", "horizon_parts", "bounded_nodes",
                                                  "node_sums",    "sheen",         "exact"};
inline constexpr std::size_t kinds_of_work = std::size(work_names);
using WorkDone = std::array<std::uint64_t, kinds_of_work>;

/// Counters that one thread adds to and any thread reads.
using WorkCounters = std::array<std::atomic<std::uint64_t>, kinds_of_work>;
WorkCounters& work_of_this_thread();
inline void count(Work what, std::uint64_t number) {
  std::atomic<std::uint64_t>& c = work_of_this_thread()[std::size_t(what)];
  c.store(c.load(std::memory_order_relaxed) + number, std::memory_order_relaxed);
}

/// The sum over all threads, since the program began.
WorkDone work_done();

}  // namespace envmap::prefiltering
