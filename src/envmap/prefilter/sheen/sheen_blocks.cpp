// Builds the layers of blocks: texels are laid on the Chebyshev points of the smallest blocks, and the points of a
// layer on those of the next.
#include "envmap/prefilter/sheen/sheen_blocks.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "envmap/base/parallel.h"
#include "envmap/maths/portable.h"
#include "envmap/maths/quadrature.h"
#include "envmap/projection/cube.h"

namespace envmap::prefiltering {

namespace {

constexpr std::size_t nodes = SheenBlocks::nodes;
constexpr std::size_t most_blocks = 1 << 17;  // In the first layer, whose blocks are larger for larger maps.
constexpr double widest = 0.25;               // Radians of a block.
using Basis = std::array<double, nodes>;

// Chebyshev's nodes on [-1, 1].
double node(std::size_t k) {
  static const Basis all = [] {
    Basis made;
    for (std::size_t i = 0; i < nodes; ++i) made[i] = -portable::cos_pi((double(i) + 0.5) / double(nodes));
    return made;
  }();
  return all[k];
}

// The part of a light at x that each node of [-1, 1] takes: Lagrange's polynomials.
Basis basis(double x) {
  Basis all;
  all.fill(1);
  for (std::size_t i = 0; i < nodes; ++i)
    for (std::size_t k = 0; k < nodes; ++k)
      if (k != i) all[i] *= (x - node(k)) / (node(i) - node(k));
  return all;
}

// A place of a face, in the frame of the face. @param x,y texels from the left and the top.
Direction place(bool latlong, double x, double y, int width, int height) {
  if (!latlong) return unit({2 * x / width - 1, 1 - 2 * y / height, 1});
  const double sine = portable::sin_pi(y / height);
  return {sine * portable::cos_pi(2 * x / width), sine * portable::sin_pi(2 * x / width), portable::cos_pi(y / height)};
}

}  // namespace

SheenBlocks::SheenBlocks(const Level& source, double unit, const Colour& min_radiance)
    : latlong_(source.projection() == Projection::latlong),
      width_(source.width()),
      height_(source.height()),
      min_radiance_(Flux(min_radiance) / unit) {
  int side = unit_side;
  while (std::size_t(faces()) * std::size_t(width_) / std::size_t(side) * std::size_t(height_) / std::size_t(side) >
         most_blocks)
    side *= 2;
  add_layer(side);
  while (layers_.back().side * texel() < 0.5 * widest) add_layer(2 * layers_.back().side);
  take_texels(source, unit, min_radiance);
  for_each_row(faces(), layers_.front().down, {}, [&](int face, int row) { sum_texels(face, row); });
  for (std::size_t k = 1; k < layers_.size(); ++k)
    for_each_row(faces(), layers_[k].down, {},
                 [&](int face, int row) { sum_blocks(layers_[k - 1], layers_[k], face, row); });
}

Direction SheenBlocks::in_face(int face, const Direction& n) const {
  if (latlong_) return {-n.z, n.x, n.y};
  const Cube::Axes& a = Cube::axes[std::size_t(face)];
  return {glm::dot(n, a.right), glm::dot(n, a.up), glm::dot(n, a.forward)};
}

void SheenBlocks::add_layer(int side) {
  Layer layer{side, (width_ + side - 1) / side, (height_ + side - 1) / side, {}, {}, {}, {}};
  const std::size_t count = layer.index(faces(), 0, 0);
  layer.light.resize(count), layer.lit.resize(count);
  for (int row = 0; row < layer.down; ++row)
    for (int column = 0; column < (latlong_ ? 1 : layer.across); ++column)
      layer.shapes.push_back(shape_of(layer, row, column));
  for (int column = 0; latlong_ && column < layer.across; ++column) {
    const double turn = 2 * (column + 0.5) * side / width_;
    layer.columns.emplace_back(portable::cos_pi(turn), portable::sin_pi(turn), 0);
  }
  layers_.push_back(std::move(layer));
}

SheenBlocks::Shape SheenBlocks::shape_of(const Layer& layer, int row, int column) const {
  const double side = layer.side, left = latlong_ ? -0.5 * side : column * side, top = row * side;
  const auto at = [&](double x, double y) { return place(latlong_, left + side * x, top + side * y, width_, height_); };
  Shape shape{at(0.5, 0.5), 0, {}};
  constexpr int steps = 8;
  for (int k = 0; k <= steps; ++k)
    for (const Direction& d :
         {at(double(k) / steps, 0), at(double(k) / steps, 1), at(0, double(k) / steps), at(1, double(k) / steps)})
      shape.radius = std::max(shape.radius, 1.02 * glm::length(d - shape.centre));
  for (std::size_t k = 0; k < std::size_t(points); ++k) {
    Direction offset(0);
    if (k < nodes * nodes) offset = at(0.5 + 0.5 * node(k % nodes), 0.5 + 0.5 * node(k / nodes)) - shape.centre;
    for (std::size_t c = 0; c < 3; ++c) shape.offset[c][k] = float(offset[int(c)]);
  }
  return shape;
}

void SheenBlocks::take_texels(const Level& source, double unit, const Colour& min_radiance) {
  const Layer& first = layers_.front();
  const auto side = std::size_t(first.side);
  texels_.resize(first.light.size() * side * side * 3);
  for_each_row(faces(), height_, {}, [&](int face, int j) {
    const auto row = source.row(face, j);
    for (std::size_t i = 0; i < row.size(); ++i) {
      const std::size_t block = first.index(face, j / first.side, int(i / side));
      for (std::size_t c = 0; c < 3; ++c)
        texels_[((block * side + std::size_t(j) % side) * 3 + c) * side + i % side] =
            float(double(row[i][int(c)] - min_radiance[int(c)]) / unit);
    }
    source.trim();
  });
}

// Sums the points of a row of the smallest blocks, by two Gauss points each way of each texel.
void SheenBlocks::sum_texels(int face, int row) {
  Layer& layer = layers_.front();
  const int side = layer.side;
  std::vector<Basis> bases;  // Weights of the Gauss points along a side.
  for (int k = 0; k < 2 * side; ++k)
    bases.push_back(basis((k / 2 + 0.5 + (k % 2 - 0.5) * quadrature::gauss_2.node[1]) * 2 / side - 1));
  for (int column = 0; column < layer.across; ++column) {
    const std::size_t block = layer.index(face, row, column);
    std::array<std::array<double, nodes * nodes>, 3> sum{};
    bool lit = false;
    for (int down = 0; down < 2 * side; ++down) {
      std::array<Basis, 3> line{};
      const double y = row * side + down / 2 + 0.5 + (down % 2 - 0.5) * quadrature::gauss_2.node[1];
      const double sine = latlong_ ? portable::sin_pi(y / height_) * pi / height_ * 2 * pi / width_ : 0;
      for (int across = 0; across < 2 * side; ++across) {
        double area = 0.25 * sine;
        if (!latlong_) {
          const double s = 2 * (column * side + across / 2 + 0.5 + (across % 2 - 0.5) * quadrature::gauss_2.node[1]) /
                               width_ -
                           1,
                       t = 1 - 2 * y / height_, square = 1 + s * s + t * t;
          area = 1 / (square * std::sqrt(square) * width_ * height_);
        }
        for (std::size_t c = 0; c < 3; ++c) {
          const double light = double(texels(block, down / 2, int(c))[across / 2]);
          lit = lit || light != 0;
          for (std::size_t k = 0; light != 0 && k < nodes; ++k)
            line[c][k] += area * light * bases[std::size_t(across)][k];
        }
      }
      for (std::size_t c = 0; c < 3; ++c)
        for (std::size_t k = 0; k < nodes * nodes; ++k)
          sum[c][k] += bases[std::size_t(down)][k / nodes] * line[c][k % nodes];
    }
    layer.lit[block] = lit;
    for (std::size_t c = 0; c < 3; ++c)
      std::ranges::transform(sum[c], layer.light[block].light[c], [](double x) { return float(x); });
  }
}

// Sums the points of a row of blocks, from the points of the four blocks in each.
void SheenBlocks::sum_blocks(const Layer& from, Layer& to, int face, int row) const {
  std::array<std::array<Basis, nodes>, 2> bases;
  for (std::size_t half = 0; half < 2; ++half)
    for (std::size_t k = 0; k < nodes; ++k) bases[half][k] = basis(0.5 * (node(k) + (half == 0 ? -1 : 1)));
  for (int column = 0; column < to.across; ++column) {
    const std::size_t block = to.index(face, row, column);
    std::array<std::array<double, nodes * nodes>, 3> sum{};
    for (int part = 0; part < 4; ++part) {
      const int r = 2 * row + part / 2, q = 2 * column + part % 2;
      if (r >= from.down || q >= from.across || from.lit[from.index(face, r, q)] == 0) continue;
      to.lit[block] = 1;
      const auto& across = bases[std::size_t(part % 2)];
      const auto& down = bases[std::size_t(part / 2)];
      for (std::size_t c = 0; c < 3; ++c)
        for (std::size_t j = 0; j < nodes; ++j) {
          Basis line{};
          for (std::size_t i = 0; i < nodes; ++i)
            for (std::size_t k = 0; k < nodes; ++k)
              line[k] += double(from.light[from.index(face, r, q)].light[c][nodes * j + i]) * across[i][k];
          for (std::size_t k = 0; k < nodes * nodes; ++k) sum[c][k] += down[j][k / nodes] * line[k % nodes];
        }
    }
    for (std::size_t c = 0; c < 3; ++c)
      std::ranges::transform(sum[c], to.light[block].light[c], [](double x) { return float(x); });
  }
}

}  // namespace envmap::prefiltering
