/// @file
/// Lagrange interpolation through equidistant nodes, and its adjoint: the part of light between nodes that each node
/// takes.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <map>
#include <utility>
#include <vector>

#include "envmap/maths/quadrature.h"

namespace envmap::prefiltering {

/// Nodes of an interpolation along one axis.
inline constexpr int nodes_across = 12;

inline constexpr int half_nodes = nodes_across / 2;
/// Weights of the nodes of one interpolation.
using Weights = std::array<double, nodes_across>;

/// For each node i, the product of 1 / (i - k) over all other nodes k.
inline constexpr Weights inverse_gaps = [] {
  Weights all{};
  for (int i = 0; i < nodes_across; ++i) {
    double gaps = 1;
    for (int k = 0; k < nodes_across; ++k)
      if (k != i) gaps *= i - k;
    all[std::size_t(i)] = 1 / gaps;
  }
  return all;
}();

/// Sets the weights of nodes floor(u) - 5 to floor(u) + 6. @return the first node.
inline int lagrange(double u, Weights& w) {
  const int first = int(std::floor(u)) - half_nodes + 1;
  const double at = u - first;
  double before = 1, after = 1;
  for (std::size_t i = 0; i < w.size(); ++i) w[i] = before * inverse_gaps[i], before *= at - double(i);
  for (std::size_t i = w.size(); i-- > 0;) w[i] *= after, after *= at - double(i);
  return first;
}

/// @return the row that a row beyond a pole of a latlong grid is, half a turn away; other rows unchanged.
inline int folded(int row, int rows) { return row < 0 ? -1 - row : row >= rows ? 2 * rows - 1 - row : row; }

/// The weight of a part of the light at a node.
struct Term {
  int from;     // Number of the part.
  bool turned;  // The part lies beyond a pole, half a turn away.
  float weight;
};
/// Terms by node.
using Terms = std::vector<std::vector<Term>>;

/// Returns the weights of `parts` equal parts of a line at its `nodes` nodes: integrals of density(position in 0 to 1)
/// x the basis. @param wraps from the last node to the first; else the line goes on mirrored, half a turn away.
template <class Density>
Terms adjoint(int parts, int nodes, bool wraps, Density&& density) {
  std::vector<std::map<std::pair<int, bool>, double>> sums(std::size_t(nodes),
                                                           std::map<std::pair<int, bool>, double>{});
  const auto& gauss = quadrature::rule<3>();
  const int panels = (nodes + parts - 1) / parts;
  const double width = 1.0 / parts / panels;
  Weights w;
  for (int k = 0; k < parts * panels; ++k)
    for (std::size_t g = 0; g < 3; ++g) {
      const double at = (k + 0.5 + 0.5 * gauss.node[g]) * width, part = 0.5 * width * gauss.weight[g] * density(at);
      const int first = lagrange(at * nodes - 0.5, w);
      for (int i = 0; i < nodes_across; ++i) {
        int node = first + i;
        const bool outside = node < 0 || node >= nodes;
        node = wraps ? (node + nodes) % nodes : folded(node, nodes);
        sums[std::size_t(node)][{k / panels, outside && !wraps}] += part * w[std::size_t(i)];
      }
    }
  Terms terms(static_cast<std::size_t>(nodes));
  for (std::size_t n = 0; n < terms.size(); ++n)
    for (const auto& [key, weight] : sums[n]) terms[n].push_back({key.first, key.second, float(weight)});
  return terms;
}

}  // namespace envmap::prefiltering
