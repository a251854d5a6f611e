/// @file
/// Elementary functions that give the same bits on every processor.
///
/// A C library picks its sin() or exp() by the processor it finds (glibc: with and without fused multiply-add), and
/// their last bits differ. These use nothing but operations that IEEE 754 rounds in one way. Bounds are in units in the
/// last place of the result (ulp), measured against long double over the ranges in tests/unit/portable_test.cpp.
#pragma once


namespace envmap {
namespace portable {

/// sin(pi x) and cos(pi x), |x| < 2^30; exact at multiples of 1/2. Error below 2 ulp.
double sin_pi(double x);
double cos_pi(double x);

/// Of x in radians, |x| < 10^5. Error below 3 ulp for |x| < 2 pi; beyond, or near zeros, 2^-52 of 1.
double sin(double x);
double cos(double x);

/// In radians, with the signs of zero and the quadrants of std::atan2; |x|, |y| < 2^1020. Error below 4 ulp.
double atan2(double y, double x);
/// In radians, of x in [-1,1]. Error below 4 ulp.
double asin(double x);
double acos(double x);

/// Error below 1 ulp; infinite or 0 beyond the range of double.
double exp(double x);
/// Error below 4 ulp.
double expm1(double x);
/// 2^x; exact for whole numbers. Error below 2 ulp.
double exp2(double x);

/// Natural, of x and of 1 + x, -infinity where that is 0 and NaN below. Error below 1 and 2 ulp.
double log(double x);
double log1p(double x);
/// Exact for powers of 2. Error below 2 ulp.
double log2(double x);

/// x^y = exp(y log x) for x >= 0. Error below 3 + |y log x| ulp.
double pow(double x, double y);
/// Error below 2 ulp.
double cbrt(double x);
/// sqrt(x^2 + y^2) without overflow. Error below 2 ulp.
double hypot(double x, double y);

}  // namespace portable
}  // namespace envmap
