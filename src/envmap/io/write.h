/// @file
/// Writing environment maps.
#pragma once

#include <optional>
#include <string>

#include "envmap/io/depth.h"
#include "envmap/map/layout.h"
#include "envmap/map/rows.h"
#include "envmap/operate/progress.h"

namespace envmap {

struct WriteOptions {
  std::optional<Layout> layout;  ///< Of a cube; column if nothing is said.
  std::string format;            ///< A file name extension for `-` and names without one; else the name's decides.
  std::optional<Depth> depth;    ///< Asked for; refused where the format cannot hold it.
  Depth source_depth = Depth::single;  ///< Taken where nothing is asked, or the nearest the format holds.
  bool clamp = false;                  ///< Values beyond what the depth holds: clamp instead of refusing.
};

struct Written {
  Depth depth;
  Layout layout;
  std::int64_t clamped = 0;  ///< Texels.
  double flux_lost = 0;      ///< Part of the map's flux that clamping took.
};

/// Says early what write() would say late: an unknown extension, a folder that cannot be written.
/// @throws UsageError or OutputError.
void check_output(const std::string& path, const WriteOptions& options, Projection projection);

/// Writes a map as its rows are made; every file appears whole or not at all, and holds no date, host or user.
/// @param path a file, `-` for standard output, or a name with `{face}` for six files. @param progress may be empty.
/// @throws OutputError where it cannot be written, or values do not fit and `clamp` is not set.
Written write(const std::string& path, const Rows& rows, const WriteOptions& options, const Progress& progress = {});

}  // namespace envmap
