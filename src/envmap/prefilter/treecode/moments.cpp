// Central moments, and the five scalars by which the theorem of treecode_kernels.h bounds the integrals over a node.
#include "envmap/prefilter/treecode/moments.h"

#include <algorithm>
#include <cmath>
#include <type_traits>

#include "envmap/prefilter/cell_moments.h"

namespace envmap::prefiltering {
namespace {

// Places in Moments3 of a product of coordinates.
constexpr std::size_t first_at(int i) { return 1 + std::size_t(i); }
constexpr std::size_t second_at(int i, int j) {
  constexpr std::size_t place[3][3] = {{0, 1, 2}, {1, 3, 4}, {2, 4, 5}};
  return 4 + place[i][j];
}
constexpr std::size_t third_at(int i, int j, int k) {
  constexpr std::size_t place[3][3][3] = {{{0, 1, 2}, {1, 3, 4}, {2, 4, 5}},
                                          {{1, 3, 4}, {3, 6, 7}, {4, 7, 8}},
                                          {{2, 4, 5}, {4, 7, 8}, {5, 8, 9}}};
  return 10 + place[i][j][k];
}

// Calls f with every i <= j, or i <= j <= k, as constants, so that the places are known at compile time.
template <class F>
void for_pairs(F&& f) {
  constexpr std::integral_constant<int, 0> x{};
  constexpr std::integral_constant<int, 1> y{};
  constexpr std::integral_constant<int, 2> z{};
  f(x, x), f(x, y), f(x, z), f(y, y), f(y, z), f(z, z);
}
template <class F>
void for_triples(F&& f) {
  constexpr std::integral_constant<int, 0> x{};
  constexpr std::integral_constant<int, 1> y{};
  constexpr std::integral_constant<int, 2> z{};
  f(x, x, x), f(x, x, y), f(x, x, z), f(x, y, y), f(x, y, z), f(x, z, z), f(y, y, y), f(y, y, z), f(y, z, z),
      f(z, z, z);
}

void add_direction(const Direction& d, double weight, Moments3& to) {
  to[0] += weight;
  for (int i = 0; i < 3; ++i) to[first_at(i)] += weight * d[i];
  for_pairs([&](auto i, auto j) { to[second_at(i, j)] += weight * d[i] * d[j]; });
  for_triples([&](auto i, auto j, auto k) { to[third_at(i, j, k)] += weight * d[i] * d[j] * d[k]; });
}

// Moves moments from the origin to c: the integrals of d - c, (d - c)^2 and (d - c)^3.
Moments3 central(const Moments3& m, const Direction& c) {
  Moments3 out{};
  const double flux = out[0] = m[0];
  for (int i = 0; i < 3; ++i) out[first_at(i)] = m[first_at(i)] - flux * c[i];
  const auto d = [&](int i) { return m[first_at(i)]; };
  const auto dd = [&](int i, int j) { return m[second_at(i, j)]; };
  for_pairs([&](auto i, auto j) { out[second_at(i, j)] = dd(i, j) - c[i] * d(j) - c[j] * d(i) + flux * c[i] * c[j]; });
  for_triples([&](auto i, auto j, auto k) {
    out[third_at(i, j, k)] = m[third_at(i, j, k)] - c[i] * dd(j, k) - c[j] * dd(i, k) - c[k] * dd(i, j) +
                             c[i] * c[j] * d(k) + c[i] * c[k] * d(j) + c[j] * c[k] * d(i) - flux * c[i] * c[j] * c[k];
  });
  return out;
}

// A symmetric matrix by second_at() - 4.
using Matrix = std::array<double, 6>;

Direction times(const Matrix& s, const Direction& a) {
  return {s[0] * a.x + s[1] * a.y + s[2] * a.z, s[1] * a.x + s[3] * a.y + s[4] * a.z,
          s[2] * a.x + s[4] * a.y + s[5] * a.z};
}
double form(const Matrix& s, const Direction& a, const Direction& b) { return glm::dot(a, times(s, b)); }

// The third moments with one index along a vector.
Matrix along(const Moments3& m, const Direction& a) {
  Matrix out;
  for_pairs([&](auto i, auto j) {
    out[second_at(i, j) - 4] = m[third_at(0, i, j)] * a.x + m[third_at(1, i, j)] * a.y + m[third_at(2, i, j)] * a.z;
  });
  return out;
}

// Two unit vectors at right angles to a node's axis and to each other.
struct Tangents {
  Direction e, f;
  explicit Tangents(const Direction& axis)
      : e(glm::normalize(glm::cross(std::abs(axis.y) < 0.9 ? Direction(0, 1, 0) : Direction(1, 0, 0), axis))),
        f(glm::cross(axis, e)) {}
};

// The largest of e.S.e over unit vectors e of the tangent plane.
double largest(const Matrix& s, const Tangents& t) {
  const double a = form(s, t.e, t.e), b = form(s, t.e, t.f), c = form(s, t.f, t.f), half = 0.5 * (a - c);
  return std::max(0.0, 0.5 * (a + c) + std::sqrt(half * half + b * b));
}

// A float that is not less than x, with a margin for the error of Gauss points and sums.
float float_above(double x) { return float(x * (1 + 1e-5)); }

struct Scalars {
  double tangent2 = 0, tangent4 = 0, tangent3 = 0, radial2 = 0, radial4 = 0;
};

// The scalars of one channel. As |d| = 1, |d-c|^2 = 1 - |c|^2 - 2 c.(d-c) is linear in d. So the fourth moment E |T|^2
// TT^T is at most E |d-c|^2 (d-c)(d-c)^T = (1 - |c|^2) S - 2 M.c, which third moments M give.
Scalars scalars_of(const Moments3& m, const Direction& c, const Direction& axis, const Tangents& t,
                   double most_radial) {
  const double away = std::max(0.0, 1 - glm::dot(c, c)), per = 1 / m[0];
  Matrix second, fourth = along(m, c);
  for (std::size_t k = 0; k < second.size(); ++k) {
    second[k] = per * m[4 + k];
    fourth[k] = away * second[k] - 2 * per * fourth[k];
  }
  Scalars s;
  s.tangent2 = std::sqrt(largest(second, t) + moment_loss);
  s.tangent4 = std::sqrt(std::sqrt(largest(fourth, t) + moment_loss));
  const Matrix cubic_e = along(m, t.e), cubic_f = along(m, t.f);
  const double x = form(cubic_e, t.e, t.e), y = form(cubic_e, t.e, t.f), z = form(cubic_e, t.f, t.f),
               w = form(cubic_f, t.f, t.f);
  s.tangent3 = per * std::sqrt(x * x + 3 * y * y + 3 * z * z + w * w) + moment_loss;
  s.radial2 = std::sqrt(std::max(0.0, form(second, axis, axis)) + moment_loss);
  s.radial4 = std::sqrt(most_radial * s.radial2);
  return s;
}

}  // namespace

template <class P>
Patch patch_of(int face, const Rect& r) {
  constexpr int n = 3;
  const auto& rule = quadrature::rule<n>();
  const double w = 0.5 * (r.u1 - r.u0), h = 0.5 * (r.v1 - r.v0), u = 0.5 * (r.u0 + r.u1), v = 0.5 * (r.v0 + r.v1);
  Patch patch;
  for (std::size_t b = 0; b < n; ++b)
    for (std::size_t a = 0; a < n; ++a) {
      const double at_u = u + w * rule.node[a], at_v = v + h * rule.node[b];
      add_direction(P::direction(face, at_u, at_v), w * h * rule.weight[a] * rule.weight[b] * P::density(at_u, at_v),
                    patch.moments);
    }
  for (int i = 0; i < 3; ++i) patch.centre[i] = patch.moments[first_at(i)] / patch.moments[0];
  for (const double at_u : {r.u0, r.u1})
    for (const double at_v : {r.v0, r.v1})
      patch.bounding_radius =
          std::max(patch.bounding_radius, glm::length(P::direction(face, at_u, at_v) - patch.centre));
  patch.bounding_radius *= 1 + 1e-3;  // A side of a texel at a pole bulges.
  return patch;
}
template Patch patch_of<Latlong>(int, const Rect&);
template Patch patch_of<Cube>(int, const Rect&);

Moments3 turned(const Moments3& m, const Rotation& turn) {
  const Rotation rows = glm::transpose(turn);
  Matrix second;
  std::copy_n(&m[4], second.size(), second.begin());
  const Direction first(m[1], m[2], m[3]);
  std::array<Matrix, 3> third;
  std::array<Direction, 3> half;
  for (int i = 0; i < 3; ++i) third[std::size_t(i)] = along(m, rows[i]), half[std::size_t(i)] = times(second, rows[i]);
  Moments3 out;
  out[0] = m[0];
  for (int i = 0; i < 3; ++i) out[first_at(i)] = glm::dot(rows[i], first);
  for_pairs([&](auto i, auto j) { out[second_at(i, j)] = glm::dot(rows[j], half[i]); });
  for_triples([&](auto i, auto j, auto k) { out[third_at(i, j, k)] = form(third[i], rows[j], rows[k]); });
  return out;
}

void set_centre(Light& light, const ChannelWeights& weights) {
  Direction sum(0);
  double all = 0;
  for (std::size_t ch = 0; ch < channels; ++ch) {
    const Moments3& m = light.moments[ch];
    all += weights[ch] * m[0];
    for (int i = 0; i < 3; ++i) sum[i] += weights[ch] * m[first_at(i)];
  }
  light.centre = all > 0 ? sum / all : Direction(0);
}

TreeNode finished(const Light& light) {
  // Light from all around has no axis. The theorem holds about any centre inside the sphere.
  const bool wide = glm::length(light.centre) < 0.3;
  const Direction c = wide ? Direction(0) : light.centre;
  const double length = glm::length(c), away = std::max(0.0, 1 - length * length);
  TreeNode n{};
  n.axis = wide ? Direction(0, 1, 0) : c / length;
  n.sag = float(away / (1 + length));
  // |d - c| <= reach: a.d >= (1 + |c|^2 - reach^2) / 2|c|.
  const double reach = light.bounding_radius * (1 + 1e-9);
  const double cosine = wide ? -1 : std::clamp((1 + length * length - reach * reach) / (2 * length) - 1e-15, -1.0, 1.0);
  n.cosine = float(cosine), n.sine = float_above(std::sqrt(std::max(0.0, (1 - cosine) * (1 + cosine)))) + 1e-7F;
  // a.(d - c) = (1 - |c|^2 - |d - c|^2) / 2|c|.
  const double most_radial = wide ? 1 : std::max(reach * reach - away, away) / (2 * length);
  const Tangents tangents(n.axis);
  for (std::size_t ch = 0; ch < channels; ++ch) {
    const Moments3 m = central(light.moments[ch], c);
    if (!(m[0] > 0)) continue;
    n.flux[ch] = float(m[0]);
    for (std::size_t i = 0; i < 3; ++i) n.first[ch][i] = float(m[1 + i]);
    for (std::size_t i = 0; i < 6; ++i) n.second[ch][i] = float(m[4 + i]);
    const Scalars s = scalars_of(m, c, n.axis, tangents, most_radial);
    n.tangent2 = std::max(n.tangent2, float_above(s.tangent2)),
    n.tangent4 = std::max(n.tangent4, float_above(s.tangent4));
    n.tangent3 = std::max(n.tangent3, float_above(s.tangent3)), n.radial2 = std::max(n.radial2, float_above(s.radial2));
    n.radial4 = std::max(n.radial4, float_above(s.radial4));
  }
  return n;
}

TreeNode node_of(const Patch& patch, const std::array<double, channels>& radiance) {
  Light one{.centre = patch.centre, .bounding_radius = patch.bounding_radius};
  one.moments[0] = patch.moments;
  TreeNode n = finished(one);
  const auto flux = n.flux[0];
  const auto second = n.second[0];
  for (std::size_t ch = 0; ch < channels; ++ch) {
    n.flux[ch] = float(radiance[ch] * flux), n.first[ch] = {};
    for (std::size_t k = 0; k < 6; ++k) n.second[ch][k] = float(radiance[ch] * second[k]);
  }
  return n;
}

}  // namespace envmap::prefiltering
