/// @file
/// What a file states of its colours, range, orientation or place on the sphere.
#pragma once

#include <string>

#include "envmap/base/export.h"

namespace ENVMAP_EXPORT envmap {

/// A statement of a file, and what reading made of it. A claim that can be neither honoured nor ignored without a wrong
/// texel is an InputError instead, which names it.
struct Claim {
  enum class Outcome {
    honoured,
    overridden,  ///< The caller said something else.
    ignored,     ///< It cannot change a texel, or the format has another claim come first.
  };

  std::string name;   ///< As the format calls it: "ICC profile", "gAMA", "EXPOSURE".
  std::string value;  ///< In a few words.
  Outcome outcome = Outcome::honoured;
  std::string reason = {};  ///< Of one that is ignored.
  bool of_colour = false;   ///< ReadOptions::colour.space overrides it.
};

constexpr const char* name(Claim::Outcome outcome) {
  return outcome == Claim::Outcome::honoured     ? "honoured"
         : outcome == Claim::Outcome::overridden ? "overridden"
                                                 : "ignored";
}

}  // namespace envmap
