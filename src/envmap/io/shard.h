/// @file
/// A map's image in parts, bands of its rows that many machines make: each an EXR file of floats whose data window is
/// the band and whose display window is the image. A part of a chain has a band of each level, one below another.
/// Joined and written they are the bytes of the map written whole.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "envmap/io/read.h"
#include "envmap/io/write.h"

namespace envmap {

struct PartNumber {
  int index, count;  ///< From 1 to count.
};

/// How the images of a map's levels are divided, given their heights: bands that differ by one row at most. A level
/// that is too small to be worth dividing is in one part alone; elsewhere its band is empty.
/// @throws UsageError where level 0 has fewer rows than there are parts.
std::vector<RowRange> bands_of(std::span<const int> heights, const PartNumber& part);

/// The image that the parts divide: all faces as `layout` says, or as they lie where nothing is said.
Grid part_grid(const WriteOptions& whole, Projection projection);

/// How to write one part of what would be written by `whole`: its facts also say which part it is, and of what.
/// @param sizes heights of a face without border, level 0 first; each half the one before, rounded down.
/// @param job what tells parts of one map from those of another: one word.
/// @throws UsageError where there are too few rows, or sizes are not those of a chain.
WriteOptions part_options(const WriteOptions& whole, Projection projection, std::span<const int> sizes,
                          const PartNumber& part, const std::string& job);

/// Whether a file is one part of a map.
bool is_part(const std::string& path);

struct MergedShards {
  EnvironmentMap map;  ///< Of all levels that the parts hold.
  WriteOptions write;  ///< As it was asked for when the parts were made.
  Facts making = {};   ///< Facts `whole-NAME` of the parts that are for what goes on with the map, without the prefix.
};

/// Reads parts in any order. @param max_pixels of the whole; larger ones are refused before memory is taken.
/// @throws InputError where a part is missing, twice there, damaged, or of another map.
MergedShards merge_shards(std::span<const std::string> paths, std::uint64_t max_pixels = default_max_pixels);

}  // namespace envmap
