/// @file
/// What the shared library shows: public headers open the namespace as `namespace ENVMAP_EXPORT envmap`.
#pragma once

#if __cplusplus < 202002L
#error "envmap needs C++20: compile with -std=c++20 or later"
#endif

// As clang reads it before the name, too.
#define ENVMAP_EXPORT [[gnu::visibility("default")]]
