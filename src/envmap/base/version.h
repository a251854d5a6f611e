/// @file
/// The version of the library that a program is compiled against.
#pragma once

/// 10000 x major + 100 x minor + patch: `#if ENVMAP_VERSION >= 10100`.
#define ENVMAP_VERSION 10000
