/// @file
/// What tests that draw have in common.
#pragma once

#include "envmap/render/context.h"

namespace drawing {

/// One for all tests of a process: drivers take long to start.
inline envmap::Context& context() {
  static envmap::Context made(envmap::ContextKind::osmesa);
  return made;
}

}  // namespace drawing
