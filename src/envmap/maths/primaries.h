/// @file
/// Linear RGB spaces by their primaries, and how they turn into one another.
#pragma once

#include "envmap/base/export.h"
#include "envmap/maths/vector.h"

namespace ENVMAP_EXPORT envmap {

/// CIE 1931 x and y of red, green and blue, and of what is called white.
struct Primaries {
  Point2 red, green, blue, white;
};

/// Columns are what red, green and blue of a source are in the target: target = matrix * source.
using ColourMatrix = glm::mat<3, 3, double, glm::mediump>;

inline const Primaries rec709{{0.64, 0.33}, {0.30, 0.60}, {0.15, 0.06}, {0.3127, 0.3290}};  ///< ITU-R BT.709-6.
/// ITU-R BT.2020-2.
inline const Primaries rec2020{{0.708, 0.292}, {0.170, 0.797}, {0.131, 0.046}, {0.3127, 0.3290}};
/// SMPTE EG 432-1.
inline const Primaries p3_d65{{0.680, 0.320}, {0.265, 0.690}, {0.150, 0.060}, {0.3127, 0.3290}};
/// SMPTE ST 2065-1.
inline const Primaries aces_ap0{{0.7347, 0.2653}, {0, 1}, {0.0001, -0.0770}, {0.32168, 0.33767}};
/// S-2014-004.
inline const Primaries aces_ap1{{0.713, 0.293}, {0.165, 0.830}, {0.128, 0.044}, {0.32168, 0.33767}};
/// Values that are CIE X, Y and Z themselves.
inline const Primaries cie_xyz{{1, 0}, {0, 1}, {0, 0}, {1.0 / 3, 1.0 / 3}};

/// Whether all coordinates agree within what files round them to.
bool same(const Primaries& a, const Primaries& b);

/// False where no light can have such primaries: they lie on one line, or white has y <= 0.
bool is_possible(const Primaries& p);

/// RGB -> CIE XYZ, with Y = 1 for white (SMPTE RP 177).
ColourMatrix to_xyz(const Primaries& p);

/// What makes XYZ under one white those under another: von Kries' scaling of Bradford's cone responses (Lam 1985;
/// ICC.1, annex E).
ColourMatrix adaptation(const Point2& from_white, const Point2& to_white);

/// White becomes white. Of cie_xyz the values are taken as relative to the target's white: XYZ have none of their own,
/// and files of them say x = y = 1/3 because those are the coordinates of (1, 1, 1).
ColourMatrix conversion(const Primaries& from, const Primaries& to);

/// What the channels count for in luminance: Y of red, green and blue.
Flux luminance_weights(const Primaries& p);

/// x and y of a black body (Krystek 1985, "An algorithm to calculate correlated colour temperature", equations 4 and 5:
/// to 1e-4 from 1000 to 15000 K). @param kelvin 1000 to 25000. @throws UsageError
Point2 black_body(double kelvin);

}  // namespace envmap
