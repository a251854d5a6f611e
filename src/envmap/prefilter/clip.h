/// @file
/// Pieces of texels that the horizon clips, for Phong lobes below exponent 1: those break off there, by a step or an
/// edge of any steepness, so that no moments of a piece say how much of it is above.
///
/// A small piece is nearly a parallelogram over which t = cos(r, l) is linear. With t = t0 + a x + b y over [-1,1]^2
/// the mean of max(t,0)^m is a second difference:
///   F(t0) = (G(t0+a+b) - G(t0+a-b) - G(t0-a+b) + G(t0-a-b)) / (4 a b (m+1) (m+2)),  G(t) = max(t,0)^(m+2).
/// What bends is a shift: t differs from that by at most `bend`, and the lobe rises with t, so its true mean over the
/// piece, but for the density, lies between F(t0 - bend) and F(t0 + bend). What a piece may be off falls with the cube
/// of its size, where taken as a point or a line it falls with the square.
#pragma once

#include <algorithm>
#include <cmath>

#include "envmap/prefilter/cell.h"
#include "envmap/prefilter/lobe.h"

namespace envmap::prefiltering {

/// A piece as a parallelogram, of any size: its bounds are theorems.
struct FlatPiece {
  double cosine;        ///< Of the angle between the direction and the middle.
  double across, down;  ///< How far that changes from the middle to the sides.
  double bend;          ///< How far it may be from a plane.
  double uneven;        ///< Most minus least of the solid angle by area, over its mean.
};

/// Taylor's remainder about the middle. Of a latlong map d is a unit vector of longitude f and colatitude g, and |d_ff|
/// = sin g, |d_fg| = |cos g|, |d_gg| = 1. Of a cube the point runs along a straight line of a plane at distance 1 or
/// more, and the second derivative of its direction is at most 1.
template <class P>
FlatPiece flat_piece(const Direction& r, int face, const Rect& rect) {
  const double u = 0.5 * (rect.u0 + rect.u1), v = 0.5 * (rect.v0 + rect.v1);
  const double half_u = 0.5 * (rect.u1 - rect.u0), half_v = 0.5 * (rect.v1 - rect.v0);
  const Direction l = P::direction(face, u, v);
  FlatPiece piece{.cosine = glm::dot(r, l)};
  if constexpr (std::is_same_v<P, Latlong>) {
    const double p = 2 * pi * half_u, q = pi * half_v, sine = std::sqrt(l.x * l.x + l.z * l.z), azimuth = 2 * (0.5 - u);
    const Direction south(l.y * portable::sin_pi(azimuth), -sine, l.y * portable::cos_pi(azimuth));
    piece.across = p * std::abs(r.x * l.z - r.z * l.x), piece.down = q * std::abs(glm::dot(r, south));
    const double most = std::min(1.0, sine + q), least = std::max(0.0, sine - q),
                 level = std::min(1.0, std::abs(l.y) + q);
    piece.bend = 0.5 * (most * p * p + 2 * level * p * q + q * q);
    piece.uneven = (most - least) * q / (sine * portable::sin_pi(half_v));
  } else {
    const Cube::Axes& axes = Cube::axes[std::size_t(face)];
    const double s = 2 * u - 1, t = 1 - 2 * v, p = 2 * half_u, q = 2 * half_v, near = glm::dot(l, axes.forward);
    const auto slope = [&](const Direction& along) {
      return near * (glm::dot(r, along) - piece.cosine * glm::dot(l, along));
    };
    piece.across = p * std::abs(slope(axes.right)), piece.down = q * std::abs(slope(axes.up));
    piece.bend = 0.5 * (p * p + q * q);
    const auto density = [](double x, double y) { return P::density(0.5 + 0.5 * x, 0.5 + 0.5 * y); };
    const double inner = density(std::max(0.0, std::abs(s) - p), std::max(0.0, std::abs(t) - q));
    const double outer = density(std::abs(s) + p, std::abs(t) + q);
    piece.uneven = (inner - outer) / outer;
  }
  return piece;
}

/// The mean of a lobe over a piece, and how far it may be off.
struct ClippedMean {
  double value, error;
};
ClippedMean clipped_mean(const Phong& lobe, const FlatPiece& piece);

}  // namespace envmap::prefiltering
