#include "envmap/maths/portable.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>

#include "envmap/maths/trigonometry-inl.h"

namespace envmap::portable {
namespace {

namespace lanes = HWY_NAMESPACE;
using One = lanes::hn::CappedTag<double, 1>;
using Vector = lanes::hn::Vec<One>;

constexpr double pi = 3.141592653589793;
constexpr double infinity = std::numeric_limits<double>::infinity();

double lane(Vector v) { return lanes::hn::GetLane(v); }

struct SinCos {
  double sine, cosine;
};

// Of pi (quarters / 2 + rest).
SinCos quarters(double quarters, double rest) {
  const One d;
  Vector s, c;
  lanes::sin_cos_quarters(d, lanes::hn::Set(d, quarters), lanes::hn::Set(d, rest), s, c);
  return {lane(s), lane(c)};
}

SinCos of_pi(double x) {
  const double k = std::nearbyint(2 * x);
  return quarters(k, x - 0.5 * k);
}

// pi/2 in three parts, the first two of 33 bits: k times them is exact (Cody and Waite 1980, "Software manual for the
// elementary functions").
SinCos of_radians(double x) {
  const double k = std::nearbyint(x * (2 / pi));
  const double rest = ((x - k * 0x1.921fb544p0) - k * 0x1.0b4611a6p-34) - k * 0x1.3198a2e037073p-69;
  return quarters(k, rest / pi);
}

// ln 2 in two parts, the first of 33 bits.
constexpr double ln2 = 0x1.62e42fefa39efp-1, ln2_high = 0x1.62e42fefp-1, ln2_low = 7.440617110012397e-11;

// x = m 2^k with m from sqrt(1/2) to sqrt(2).
struct Parts {
  double m;
  int k;
};
Parts parts_of(double x) {
  int k = 0;
  double m = 2 * std::frexp(x, &k);
  --k;
  if (m > 0x1.6a09e667f3bcdp0) m *= 0.5, ++k;
  return {m, k};
}

// k ln 2 + log(1 + f) + tail, |f| < 0.42. With s = f / (2 + f), log(1 + f) = 2 atanh(s) = f - f s + s^3 R(s^2), and
// f s = f^2/2 - s f^2/2 keeps the digits (Tang 1990, "Table-driven implementation of the logarithm function", writes
// the same series). The coefficients of R are interpolated at Chebyshev nodes as in trigonometry.py, to 6e-18.
double log_of(double k, double f, double tail) {
  const double s = f / (2 + f), z = s * s;
  const double r =
      z * (0.666666666666667 +
           z * (0.39999999999886615 +
                z * (0.28571428631764334 +
                     z * (0.2222221019926421 +
                          z * (0.18182956608063458 + z * (0.15329500754204178 + z * 0.14643628601909797))))));
  const double half = 0.5 * f * f;
  return k * ln2_high - ((half - (s * (half + r) + (k * ln2_low + tail))) - f);
}

// e^(high - low), |high - low| < 0.35: with r that argument and c = r - r^2 Q(r^2), 1 + 2 r / (2 - c)... = 1 + r + r c
// / (2 - c); Q from r coth(r/2), interpolated to 1e-18.
double exp_near_0(double high, double low) {
  const double r = high - low, z = r * r;
  const double c =
      r - z * (0.1666666666666666 +
               z * (-0.002777777777754694 +
                    z * (6.613756462990855e-05 + z * (-1.653404675614338e-06 + z * 4.143141020859654e-08))));
  return 1 + (high - (low - r * c / (2 - c)));
}

// As nearbyint() and ldexp(), in less time. |x| < 2^51.
double nearest_whole(double x) { return (x + 0x1.8p52) - 0x1.8p52; }
double scaled(double x, double k) {
  if (!(std::abs(k) <= 1022)) return std::ldexp(x, int(k));
  return x * std::bit_cast<double>(std::uint64_t(int(k) + 1023) << 52);
}

}  // namespace

double sin_pi(double x) { return of_pi(x).sine; }
double cos_pi(double x) { return of_pi(x).cosine; }
double sin(double x) { return of_radians(x).sine; }
double cos(double x) { return of_radians(x).cosine; }

double atan2(double y, double x) {
  const One d;
  return pi * lane(lanes::atan2_pi(d, lanes::hn::Set(d, y), lanes::hn::Set(d, x)));
}
double asin(double x) { return atan2(x, std::sqrt((1 - x) * (1 + x))); }
double acos(double x) { return atan2(std::sqrt((1 - x) * (1 + x)), x); }

double exp(double x) {
  if (!(x < 710)) return x * infinity;  // NaN stays NaN.
  if (x < -746) return 0;
  const double k = nearest_whole(x / ln2);
  return scaled(exp_near_0(x - k * ln2_high, k * ln2_low), k);
}

double exp2(double x) {
  if (!(x < 1025)) return x * infinity;
  if (x < -1076) return 0;
  const double k = nearest_whole(x);
  return scaled(exp_near_0((x - k) * ln2, 0), k);
}

double expm1(double x) {
  if (std::abs(x) > 0.35) return exp(x) - 1;
  // x / (1 - x/2 + x^2/12 ...): the exponential's own fraction without its 1.
  const double z = x * x;
  const double c =
      x - z * (0.1666666666666666 +
               z * (-0.002777777777754694 +
                    z * (6.613756462990855e-05 + z * (-1.653404675614338e-06 + z * 4.143141020859654e-08))));
  return x + x * c / (2 - c);
}

double log(double x) {
  if (!(x > 0)) return x == 0 ? -infinity : std::numeric_limits<double>::quiet_NaN();
  if (x == infinity) return x;
  const auto [m, k] = parts_of(x);
  return log_of(k, m - 1, 0);
}

double log1p(double x) {
  if (!(x > -1)) return x == -1 ? -infinity : std::numeric_limits<double>::quiet_NaN();
  if (x == infinity) return x;
  if (std::abs(x) < 0.29) return log_of(0, x, 0);
  // What rounding 1 + x lost, over it.
  const double sum = 1 + x, lost = x >= 1 ? 1 - (sum - x) : x - (sum - 1);
  const auto [m, k] = parts_of(sum);
  return log_of(k, m - 1, lost / sum);
}

double log2(double x) {
  if (!(x > 0) || x == infinity) return log(x);
  const auto [m, k] = parts_of(x);
  return k + log_of(0, m - 1, 0) / ln2;
}

double pow(double x, double y) {
  if (y == 0 || x == 1) return 1;
  if (x == 0) return y > 0 ? 0 : infinity;
  return exp(y * log(x));
}

double cbrt(double x) {
  if (x == 0 || !std::isfinite(x)) return x;
  const double size = std::abs(x), guess = exp(log(size) / 3);
  // One step of Newton's method takes off what the exponential's argument lost.
  return std::copysign(guess - (guess - size / (guess * guess)) / 3, x);
}

double hypot(double x, double y) {
  const double low = std::min(std::abs(x), std::abs(y)), high = std::max(std::abs(x), std::abs(y));
  if (high > 0x1p-500 && high < 0x1p500) return std::sqrt(high * high + low * low);
  if (high == 0 || std::isinf(high)) return high;
  const int scale = std::ilogb(high);
  const double a = std::ldexp(high, -scale), b = std::ldexp(low, -scale);
  return std::ldexp(std::sqrt(a * a + b * b), scale);
}

}  // namespace envmap::portable
