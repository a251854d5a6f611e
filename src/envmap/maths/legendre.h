/// @file
/// Associated Legendre functions P_l^m of y, normalised over the sphere, upwards in degree, which is stable (Press et
/// al. 2007, "Numerical recipes", 6.7):
///   P_0^0 = sqrt(1 / (4 pi)),  P_{m+1}^{m+1} = diagonal(m) sin P_m^m,  P_l^m = a (y P_{l-1}^m - b P_{l-2}^m).
#pragma once

#include <cmath>

#include "envmap/maths/vector.h"

namespace envmap::legendre {

inline double first() { return std::sqrt(0.25 / pi); }

inline double diagonal(int m) { return std::sqrt((2 * m + 3) / (2.0 * m + 2)); }

struct Step {
  double a, b;
};
/// @param l above m.
inline Step step(int l, int m) {
  const double ll = 1.0 * l * l, mm = 1.0 * m * m, k = 1.0 * (l - 1) * (l - 1);
  return {std::sqrt((4 * ll - 1) / (ll - mm)), l > m + 1 ? std::sqrt((k - mm) / (4 * k - 1)) : 0};
}

}  // namespace envmap::legendre
