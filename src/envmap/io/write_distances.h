// Maps whose EXR file says how far away the surfaces are.
#pragma once

#include <span>
#include <string>

#include "envmap/io/write.h"

namespace envmap {

/// Says early what write_with_distances() would say late. @throws UsageError.
void check_distances(const std::string& path, const WriteOptions& options);

/// Writes a map of one level as write() does, to one EXR file with a channel Z beside R, G and B: floats, infinite
/// where no face lies in the image. @param distances one a texel, in the order of faces, rows and columns.
Written write_with_distances(const std::string& path, const EnvironmentMap& map, std::span<const float> distances,
                             const WriteOptions& options = {}, const Run& run = {});

}  // namespace envmap
