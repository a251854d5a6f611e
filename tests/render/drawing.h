/// @file
/// What tests that draw have in common.
#pragma once

#include <string_view>

#include "envmap/scenes/render/context.h"
#include "on_processor.h"

namespace drawing {

/// One for all tests of a process: drivers take long to start.
inline envmap::Context& context() {
  using envmap::ContextKind;
  static envmap::Context made(on_processor() == std::string_view("egl") ? ContextKind::egl : ContextKind::osmesa);
  return made;
}

}  // namespace drawing
