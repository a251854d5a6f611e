/// @file
/// Writing environment maps.
#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "envmap/base/export.h"
#include "envmap/base/run.h"
#include "envmap/io/claims/colour.h"
#include "envmap/io/face_files.h"
#include "envmap/io/files/commit.h"
#include "envmap/io/images/depth.h"
#include "envmap/io/metadata.h"
#include "envmap/map/layout.h"
#include "envmap/map/rows.h"

namespace ENVMAP_EXPORT envmap {

struct WriteOptions {
  std::optional<Layout> layout = {};  ///< Of a cube; column if nothing is said.
  std::string faces = {};             ///< Names and turns of the six files of a name with `{face}`: see face_files().
  std::string format = {};            ///< A file name extension for `-` and names without one; else the name's decides.
  std::optional<Depth> depth = {};    ///< Asked for; refused where the format cannot hold it.
  Depth source_depth = Depth::single;  ///< Taken where nothing is asked, or the nearest the format holds.
  bool clamp = false;                  ///< Values beyond what the depth holds: clamp instead of refusing.
  bool openexr_envmap = false;   ///< OpenEXR's envmap attribute, samples on the border: EXR, latlong or cube column.
  std::string compression = {};  ///< Of an EXR file, zip, zip:1, piz, dwaa:45, ...; zip if empty.
  /// Texels written round every level of an octahedral map, which repeat what lies beyond its edges.
  int border = 0;
  bool zstd = false;     ///< Compress KTX2 files with Zstandard.
  bool encoded = false;  ///< Allow a space that is not linear in a format whose values other programs take for linear.
  Facts facts = {};      ///< Further metadata, such as the lobe: attributes envmap:NAME.
  /// Key/value pairs of a KTX or KTX2 file as they stand: Filament's "sh".
  std::map<std::string, std::string> pairs = {};
  CommitOptions commit = {};
  ColourOptions colour = {};  ///< Space of the values in the file; integers are sRGB where nothing is said.
  /// Make and write these rows of the images alone, a range for each level: one EXR file. Of one level the rows are its
  /// data window, and the image is its display window. Of several the ranges lie below one another, level 0's first.
  std::vector<RowRange> rows = {};
  Provenance provenance = {};  ///< Of the map that this one was made of; formats hold what they can.
};

struct Written {
  Depth depth;
  Layout layout;
  std::int64_t clamped = 0;  ///< Texels, of all levels.
  double flux_lost = 0;      ///< Part of a level's flux that clamping took; of several levels, the largest.
};

/// Says early what write() would say late: an unknown extension, a folder that cannot be written.
/// @param levels whether there will be more than one. @throws UsageError or OutputError.
void check_output(const std::string& path, const WriteOptions& options, Projection projection, bool levels = false);

/// Writes a map with its levels as their rows are made; every file appears whole or not at all, and holds no date, host
/// or user. EXR holds levels, in tiles (down to one texel: a chain that ends early is gone on with, and envmap:levels
/// says where it ended), as do KTX, KTX2 and DDS; for other formats and for files of one face the name must have
/// `{level}`.
/// @param path a file, `-` for standard output, or a name with `{face}` for six files, `{half}` for a paraboloid's two
/// and `{level}` for one a level.
/// @param levels the base first; each half the one before, rounded down (see half_level()); with their border, where
/// there shall be one.
/// @throws OutputError where it cannot be written, or values do not fit and `clamp` is not set.
Written write(const std::string& path, std::span<const Rows> levels, const WriteOptions& options = {},
              const Run& run = {});
Written write(const std::string& path, const Rows& rows, const WriteOptions& options = {}, const Run& run = {});
/// All levels of the map.
Written write(const std::string& path, const EnvironmentMap& map, const WriteOptions& options = {},
              const Run& run = {});

/// Returns the bytes of the file that write() would write; no file is made. Errors name no file.
/// @param options `format` names the format by its extension, such as "exr"; `commit` has no meaning.
std::vector<std::byte> encode(const EnvironmentMap& map, const WriteOptions& options, const Run& run = {});
std::vector<std::byte> encode(std::span<const Rows> levels, const WriteOptions& options, const Run& run = {});

}  // namespace envmap
