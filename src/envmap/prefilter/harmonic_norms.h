/// @file
/// What the first nine real orthonormal harmonics have before their polynomials.
#pragma once

namespace envmap::harmonic_norms {

inline constexpr double n0 = 0.28209479177387814;   ///< 1: sqrt(1 / (4 pi)).
inline constexpr double n1 = 0.4886025119029199;    ///< x, y and z: sqrt(3 / (4 pi)).
inline constexpr double n2 = 1.0925484305920792;    ///< xy, yz and zx: sqrt(15 / (4 pi)).
inline constexpr double n20 = 0.31539156525252005;  ///< 3z^2 - 1 of the polar axis z: sqrt(5 / (16 pi)).
inline constexpr double n22 = n2 / 2;               ///< x^2 - y^2.

}  // namespace envmap::harmonic_norms
