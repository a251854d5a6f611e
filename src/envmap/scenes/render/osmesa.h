/// @file
/// The functions of OSMesa that are loaded at run time, declared here because Mesa 25.1 removed OSMesa and its header.
/// Names and values: Mesa 22.3, GL/osmesa.h.
#pragma once

namespace envmap::osmesa {

using Context = struct Opaque*;

using Create = Context(const int* attributes, Context share);
using MakeCurrent = unsigned char(Context context, void* buffer, unsigned type, int width, int height);
using Destroy = void(Context context);

inline constexpr int rgba = 0x1908, format = 0x22, depth_bits = 0x30, profile = 0x33, core_profile = 0x34,
                     major_version = 0x36, minor_version = 0x37;

}  // namespace envmap::osmesa
