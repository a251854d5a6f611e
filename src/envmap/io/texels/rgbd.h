/// @file
/// Radiance as bytes of RGBD in PNG images, as Babylon.js and the glTF extension EXT_lights_image_based have it:
/// colours are divided by alpha, after the power 2.2 (fromRGBD in Babylon.js' shadersStore helperFunctions).
#pragma once

#include <array>
#include <cstddef>
#include <functional>
#include <span>
#include <vector>

#include "envmap/base/run.h"
#include "envmap/io/texels/texture_file.h"
#include "envmap/map/atlas.h"
#include "envmap/maths/vector.h"

namespace envmap {

/// The largest value: 1 over an alpha of 1/255.
inline constexpr double largest_rgbd = 255;

/// Four bytes a texel: the largest alpha that leaves all colours below 1, and the nearest bytes to colour x alpha.
/// Values must be finite, not negative and at most `largest_rgbd`.
void encode_rgbd(std::span<const Colour> from, std::span<std::byte> to);
/// An alpha of 0 is black.
void decode_rgbd(std::span<const std::byte> from, std::span<Colour> to);

/// PNG files of the six faces of one level. As Babylon.js reads them, out of .env and glTF files alike: each image is
/// turned upside down, and X is negated, its world being left-handed.
using RgbdFaces = std::array<std::vector<char>, 6>;

/// Levels as PNG files, the largest first. @param levels columns of faces in the API's orientation.
/// @param progress may be empty.
std::vector<RgbdFaces> rgbd_faces(std::span<const Atlas> levels, const Progress& progress);

/// The bytes of an image file, one of many that a file holds or names.
using FaceImage = std::function<std::vector<std::byte>(const InputFile& file, std::size_t index)>;

/// A cube out of such images. @param image is asked for six of them for each level, the largest first: PNG, or JPEG,
/// which has no alpha to divide by. @param size bytes of all of them. @throws InputError, as its `bytes` do, without
/// the file's name, where one is no image of the level's size.
TextureFile rgbd_texture(const InputFile& file, const char* container, std::size_t images, const FaceImage& image,
                         std::uint64_t size);

}  // namespace envmap
