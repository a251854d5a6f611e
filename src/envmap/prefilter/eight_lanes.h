/// @file
/// Included before Highway by sums of eight lanes: AVX-512 would gain them nothing, and take a quarter of their compile
/// time.
#pragma once

#undef HWY_DISABLED_TARGETS
#define HWY_DISABLED_TARGETS (ENVMAP_DISABLED_TARGETS | (HWY_AVX2 - 1))
