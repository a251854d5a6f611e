/// @file
/// The six files of a cube, as other programs name them and turn their pictures.
#pragma once

#include <array>
#include <span>
#include <string>
#include <string_view>

#include "envmap/base/export.h"
#include "envmap/io/images/image_reader.h"

namespace ENVMAP_EXPORT envmap {

struct FaceFile {
  std::string name;                           ///< What stands for `{face}` in the file name.
  Orientation stored = Orientation::upright;  ///< How the picture lies in the file; upright is as in memory.
};

/// In the order +X -X +Y -Y +Z -Z.
using FaceFiles = std::array<FaceFile, 6>;

struct FaceConvention {
  std::string_view name;
  std::string_view files;  ///< As face_files() reads them.
  std::string_view title;  ///< Who names faces so.
};

/// All of them, by name.
std::span<const FaceConvention> face_conventions();

/// @param text a convention's name; or six names with commas between them, in the order +X -X +Y -Y +Z -Z, each
/// NAME[:mirror][:90|:180|:270] for a picture that is mirrored left to right and then turned clockwise; or
/// CONVENTION:NAME,...,NAME for pictures that lie as the convention has them. Empty: px nx py ny pz nz, as in memory.
/// @throws UsageError where it is none of these.
FaceFiles face_files(std::string_view text);

/// A place of one image that holds all faces of a cube: the face in it, from 0, and how it lies there.
struct FaceCell {
  std::size_t face;
  Orientation stored;
};

/// The places of such an image, from left to right and from the top. @param text as face_files() has it: the order of
/// its names, which are px nx py ny pz nz (or +X -X ...), is that of the places; or a convention alone, which says how
/// faces lie in the usual order. @throws UsageError where it is none of these.
std::array<FaceCell, 6> face_cells(std::string_view text);

/// The convention that such a text names, or nothing.
std::string_view convention_of(std::string_view text);

}  // namespace envmap
