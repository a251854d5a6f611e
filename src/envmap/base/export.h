/// @file
/// What the shared library shows: public headers open the namespace as `namespace ENVMAP_EXPORT envmap`.
#pragma once

#define ENVMAP_EXPORT __attribute__((visibility("default")))
