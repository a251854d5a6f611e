/// @file
/// What draws on the processor here. Graphics cards round otherwise.
#pragma once

#include <dlfcn.h>

#include <cstdlib>

/// For --context: OSMesa, or EGL where Mesa has none, with Mesa told to leave the card alone.
inline const char* on_processor() {
  ::setenv("LIBGL_ALWAYS_SOFTWARE", "1", 1);
  static const bool osmesa = ::dlopen("libOSMesa.so.8", RTLD_LAZY | RTLD_LOCAL) != nullptr;
  return osmesa ? "osmesa" : "egl";
}
