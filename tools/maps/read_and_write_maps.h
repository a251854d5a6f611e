// Reads and writes maps, with messages.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "envmap/io/read.h"
#include "envmap/io/write.h"

namespace tools {

/// Reads a map. Says what was repaired, assumed or left out.
envmap::Source read_map(const std::string& path, const envmap::ReadOptions& options);
/// The same of an image that is no map: its level holds the pixels.
envmap::Source read_picture(const std::string& path, const envmap::ReadOptions& options);

/// Words where several of the brightest texels have one value, as a light does that was clipped: its flux is then wrong
/// in what is made of the map. Empty elsewhere. @param command that makes it.
std::string equal_brightest(std::string_view command, const std::string& path, const envmap::EnvironmentMap& map);

/// Whether a file has levels of a lobe, as prefilter writes them.
bool is_prefiltered_chain(const envmap::Source& source);

/// Makes and writes a map with its levels, and the depfile. Says how many texels were clamped.
/// @param verb for the progress line.
envmap::Written write_map(const std::string& path, std::span<const envmap::Rows> levels,
                          const envmap::WriteOptions& options, const std::string& verb);
/// Writes a map of one level with distances in a channel Z, and its centre as the fact `at`.
void write_distances(const std::string& path, const envmap::EnvironmentMap& map, std::span<const float> distances,
                     const envmap::Direction& at, const envmap::WriteOptions& options);
/// Warns of what --clamp took, if anything.
void tell_clamping(const std::string& path, const envmap::Written& written);
/// Says that the file does not hold the axis at its centre, where that is not +z, or the unit of radiance.
void tell_lost_facts(const std::string& path, const envmap::Frame& frame, const envmap::WriteOptions& options);
envmap::Written write_map(const std::string& path, const envmap::Rows& rows, const envmap::WriteOptions& options,
                          const std::string& verb);

/// Writes a text to a file or to standard output ("-").
void write_text(const std::string& path, std::string_view text);

}  // namespace tools
