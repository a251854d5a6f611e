/// @file
/// What the shared library shows: public headers open the namespace as `namespace ENVMAP_EXPORT envmap`.
#pragma once

// As clang reads it before the name, too.
#define ENVMAP_EXPORT [[gnu::visibility("default")]]
