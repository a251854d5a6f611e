/// @file
/// Included before Highway by code that AVX-512 makes no faster, such as sums of eight lanes. Without it a quarter of
/// the compile time goes.
#pragma once

#undef HWY_DISABLED_TARGETS
#define HWY_DISABLED_TARGETS (ENVMAP_DISABLED_TARGETS | (HWY_AVX2 - 1))
