/// @file
/// What a file says of the map it holds.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <string_view>

#include "envmap/base/export.h"
#include "envmap/io/images/image_reader.h"
#include "envmap/map/environment_map.h"
#include "envmap/map/layout.h"

namespace ENVMAP_EXPORT envmap {

/// Further facts by name, such as the lobe of a prefiltered map: attributes envmap:NAME. One word each, no spaces.
using Facts = std::map<std::string, std::string>;

/// Of one face of six files: the convention by which they were written, unless it is that of memory.
inline constexpr std::string_view faces_fact = "faces";

/// Of a file of write_table(), which is no map: the lobe.
inline constexpr std::string_view table_fact = "table";

/// The attributes envmap:projection, envmap:layout, envmap:forward, envmap:levels, envmap:border, envmap:space,
/// envmap:white (candelas per square metre of radiance 1) and envmap:NAME of other facts. Formats without attributes of
/// one's own carry them as words of the image description ("envmap:projection=cube envmap:layout=row").
struct Metadata {
  std::optional<Projection> projection = {};
  std::optional<Layout> layout = {};
  std::optional<Forward> forward = {};
  std::optional<int> levels = {};  ///< Of a chain that ends early in a file that must go on to one texel.
  std::optional<int> border = {};  ///< Texels round an octahedral map: map/octahedral_border.h.
  /// Of its values, by the name of a built-in colour space without spaces (io/claims/colour.h); else empty.
  std::string space = {};
  Facts facts = {};
  Provenance provenance = {};
};

/// Values that mean nothing to this version are passed over.
Metadata metadata(const ImageFacts& image);
Attributes attributes(const Metadata& data);

/// Facts come out of files and go into others: each name and text must be one short word of plain characters.
bool is_word(const std::string& text);

/// The same, as name and text without the prefix `envmap:`.
Metadata metadata(Facts facts);
Facts facts(const Metadata& data);

std::optional<Forward> forward_named(std::string_view name);

/// Whether the file has OpenEXR's `envmap` attribute: its samples lie on the border of the image, the first row at the
/// pole, first and last column on one meridian, cube texels on the edges (OpenEXR's ImfEnvmap.h).
bool has_border_samples(const Attributes& texts);

}  // namespace envmap
