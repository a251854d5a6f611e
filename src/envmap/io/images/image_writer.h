/// @file
/// An image being written, whichever library writes it.
#pragma once

#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "envmap/io/files/output_file.h"
#include "envmap/io/images/image_reader.h"
#include "envmap/map/rows.h"
#include "envmap/maths/vector.h"

namespace envmap {

struct Size {
  int width, height;
};

/// What is to be written.
struct ImagePlan {
  /// One; or several in an EXR file, each half the one before and rounded down to 1x1: then in tiles.
  std::vector<Size> levels;
  Depth depth = Depth::single;  ///< One that the format holds.
  Attributes attributes = {};
  Provenance provenance = {};    ///< The colours alone: texts are attributes.
  std::string compression = {};  ///< Of EXR: zip, zip:1, piz, dwaa:45, ...; zip if empty.
  /// Of integers; empty: none is known, and sRGB they are not. Unset: sRGB.
  std::optional<std::string> icc_profile = {};
  std::optional<RowRange> rows = {};                 ///< Of an EXR file of one level: these alone, its data window.
  bool latlong_envmap = false, cube_envmap = false;  ///< OpenEXR's `envmap` attribute.
  /// Of an EXR file of one level: what its channel Z holds in rows [begin, end). Empty: there is none.
  std::function<void(int begin, int end, std::span<float> out)> distances = {};
};

struct ImageWriter {
  /// The next rows of a level, in order; of levels in tiles whole rows of them, `tile_size` high. Values are as they
  /// are to be stored: linear for floats, sRGB encoded from 0 to 1 for integers.
  std::function<void(int level, int begin, int end, std::span<const Colour> rows)> write;
  /// Writes what is left; the file is to be committed after that.
  std::function<void()> close;
};

/// The side of a tile.
inline constexpr int tile_size = 64;

/// @param file must outlive the writer. @param path for messages. @param extension exr, or of what OpenImageIO writes.
/// @throws OutputError, as do its functions.
ImageWriter make_writer(OutputFile& file, const std::string& path, const std::string& extension, const ImagePlan& plan);

}  // namespace envmap
