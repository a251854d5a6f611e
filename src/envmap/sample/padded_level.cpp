#include "envmap/sample/padded_level.h"
#include "envmap/projection/visit.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "envmap/sample/point.h"

namespace envmap {
namespace {

struct ApronTexel {
  int face, i, j;
  Direction beyond;         // Where the projection continues to at this texel.
  Location<double> source;  // What part of the image shows that direction.
};

bool in_face(const PaddedLevel& level, int i, int j) {
  return i >= 0 && j >= 0 && i < level.width() && j < level.height();
}

// Distance of a texel's centre from the middle of the disc, which has radius 1.
double radius(const PaddedLevel& level, int i, int j) {
  const double n = level.height();
  return glm::length(Point2((2 * i + 1) / n - 1, 1 - (2 * j + 1) / n));
}

bool is_image(const PaddedLevel& level, int i, int j) {
  return in_face(level, i, j) && (!on_disc(level.projection()) || radius(level, i, j) <= 1);
}

// Of a disc, the texels that a tap can reach: at most sqrt(2) x apron texels of width 2/n from the place it is read
// for.
bool is_apron(const PaddedLevel& level, int i, int j) {
  if (is_image(level, i, j)) return false;
  return !on_disc(level.projection()) ||
         radius(level, i, j) <= 1 + 2 * std::numbers::sqrt2 * Level::padding / level.height();
}

std::vector<ApronTexel> apron_texels(const PaddedLevel& level) {
  constexpr int g = Level::padding;
  const int w = level.width(), h = level.height();
  std::vector<ApronTexel> found;
  visit(level.projection(), [&](auto p) {
    using P = decltype(p);
    for (int face = 0; face < level.faces(); ++face)
      for (int j = -g; j < h + g; ++j)
        for (int i = -g; i < w + g; ++i) {
          if (!P::on_disc && i == 0 && j >= 0 && j < h) i = w;  // All of an inner row is image.
          if (!is_apron(level, i, j)) continue;
          // Round a disc of one or two texels some lie so far out that they would have gone round the sphere once.
          const double pull = P::on_disc ? std::min(1.0, 1.9 / radius(level, i, j)) : 1;
          const Direction beyond =
              P::direction(face, 0.5 + pull * ((i + 0.5) / w - 0.5), 0.5 + pull * ((j + 0.5) / h - 0.5));
          found.push_back({face, i, j, beyond, P::locate(beyond)});
        }
  });
  return found;
}

constexpr std::size_t between_trims = 256;

// ---- rims -----------------------------------------------------------------------------------------------------------

// A plane through weighted samples in the tangent plane of a direction: moving least squares (Lancaster and Salkauskas
// 1981) with weights that grow without bound towards a sample, so that the plane passes through one that is met.
class TangentFit {
 public:
  explicit TangentFit(const Direction& at) : at_(at) {
    e1_ = glm::normalize(glm::cross(std::abs(at.x) < 0.7 ? Direction(1, 0, 0) : Direction(0, 1, 0), at));
    e2_ = glm::cross(at, e1_);
  }

  void add(const Direction& d, const Colour& c, double weight) {
    const double x = glm::dot(d - at_, e1_), y = glm::dot(d - at_, e2_);
    const Direction p(1, x, y);
    const Rgb<double> value(c);
    for (int k = 0; k < 3; ++k) {
      normal_[k] += weight * p[k] * p;
      right_[k] += weight * p[k] * value;
    }
    low_ = glm::min(low_, c);
    high_ = glm::max(high_, c);
  }

  // Nothing near is image: only round maps of one or two texels.
  [[nodiscard]] bool empty() const { return normal_[0][0] == 0; }

  // The plane's height at the direction, within the range of the samples: a slope beside a sun must not go below 0.
  [[nodiscard]] Colour value() const {
    glm::dmat3 m = normal_;
    const double slope = 1e-7 * (m[0][0] * 1e-9 + m[1][1] + m[2][2]);  // Where all samples lie on a line or a point.
    m[1][1] += slope;
    m[2][2] += slope;
    const Direction weights = glm::inverse(m)[0];  // Symmetric: its first row.
    return glm::clamp(Colour(weights.x * right_[0] + weights.y * right_[1] + weights.z * right_[2]), low_, high_);
  }

 private:
  Direction at_, e1_, e2_;
  glm::dmat3 normal_{0};
  Rgb<double> right_[3]{Rgb<double>(0), Rgb<double>(0), Rgb<double>(0)};
  Colour low_{std::numeric_limits<float>::max()}, high_{0};
};

// Adds the image texels within `reach` of a place given in texels of a face.
void add_neighbours(TangentFit& fit, const PaddedLevel& level, int face, double x, double y) {
  constexpr double reach = 2.6;
  constexpr std::size_t most = 36;  // Whole numbers in an interval 2 x 2.6 long: six at most, each way.
  const int n = level.height();
  std::array<Point2, most> places;
  std::array<const Colour*, most> colours;
  std::array<double, most> weights;
  std::size_t count = 0;
  for (int j = int(std::ceil(y - reach)); j <= y + reach; ++j)
    for (int i = int(std::ceil(x - reach)); i <= x + reach; ++i) {
      const double distance = glm::length(Point2(i - x, j - y));
      if (distance >= reach || !is_image(level, i, j)) continue;
      const double near = (reach - distance) / (distance + 1e-6);
      places[count] = {(i + 0.5) / n, (j + 0.5) / n};
      colours[count] = level.texel(face, i, j);
      weights[count++] = near * near * near;
    }
  std::array<Direction, most> d;
  directions(level.projection(), face, std::span(places).first(count), std::span(d).first(count));
  for (std::size_t k = 0; k < count; ++k) fit.add(d[k], *colours[k], weights[k]);
}

}  // namespace

PaddedLevel::PaddedLevel(const Level& level) : PaddedLevel(level.clone()) {}

PaddedLevel::PaddedLevel(Level&& level) : level_(std::move(level)) {
  if (is_octahedral(projection()))
    fill_by_folding();
  else
    on_disc(projection()) ? fill_by_fit() : fill_by_bilinear();
}

// Of faces whose edges follow their texels: cube, latlong. Some taps are apron themselves, with a weight of about half
// a texel / size: start from the nearest texel of the image, then repeat, which contracts.
void PaddedLevel::fill_by_bilinear() {
  const std::vector<ApronTexel> texels = apron_texels(*this);
  std::vector<Colour> values(texels.size());
  for (int round = 0; round < 4; ++round) {
    for (std::size_t k = 0; k < texels.size(); ++k) {
      if (k % between_trims == 0) trim();
      values[k] = round == 0 ? nearest(*this, texels[k].source) : bilinear(*this, texels[k].source);
    }
    for (std::size_t k = 0; k < texels.size(); ++k) {
      if (k % between_trims == 0) trim();
      *level_.stored(texels[k].face, texels[k].i, texels[k].j) = values[k];
    }
  }
}

// A square folded onto itself: what lies beyond its sides are texels of the image.
void PaddedLevel::fill_by_folding() {
  constexpr int g = Level::padding;
  const int n = height();
  for (int j = -g; j < n + g; ++j) {
    for (int i = -g; i < n + g; ++i) {
      if (i == 0 && j >= 0 && j < n) i = n;  // All of an inner row is image.
      const auto [from_i, from_j] = octahedron::wrapped_texel(i, j, n);
      *level_.stored(0, i, j) = *texel(0, from_i, from_j);
    }
    if (j % 16 == 0) trim();
  }
}

// The texels just outside a rim and those of the other half (or of the opposite rim) at the same place are each
// other's neighbours, so no iteration between them gets anywhere: the image texels on both sides are fitted instead.
// The fit reads image texels alone, so each apron texel is written as soon as it is known.
void PaddedLevel::fill_by_fit() {
  const std::vector<ApronTexel> texels = apron_texels(*this);
  for (std::size_t k = 0; k < texels.size(); ++k) {
    const ApronTexel& t = texels[k];
    if (k % between_trims == 0) trim();
    TangentFit fit(t.beyond);
    add_neighbours(fit, *this, t.face, t.i, t.j);
    add_neighbours(fit, *this, t.source.face, t.source.u * width() - 0.5, t.source.v * height() - 0.5);
    *level_.stored(t.face, t.i, t.j) = fit.empty() ? *texel(0, width() / 2, height() / 2) : fit.value();
  }
}

}  // namespace envmap
