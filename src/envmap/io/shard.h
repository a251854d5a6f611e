/// @file
/// A map's image in parts, bands of its rows that many machines make: each an EXR file of floats whose data window is
/// the band and whose display window is the image. Joined and written they are the bytes of the map written whole.
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

/// How rows are divided: bands that differ by one row at most.
/// @throws UsageError where there are fewer rows than parts.
RowRange band_of(int rows, const PartNumber& part);

/// The image that the parts divide: all faces as `layout` says, or as they lie where nothing is said.
Grid part_grid(const WriteOptions& whole, Projection projection);

/// How to write one part of what would be written by `whole`: its facts also say which part it is, and of what.
/// @param job what tells parts of one map from those of another: one word.
WriteOptions part_options(const WriteOptions& whole, const Rows& rows, const PartNumber& part, const std::string& job);

struct MergedShards {
  EnvironmentMap map;  ///< Of one level.
  WriteOptions write;  ///< As it was asked for when the parts were made.
  Facts making = {};   ///< Facts `whole-NAME` of the parts that are for what goes on with the map, without the prefix.
};

/// Reads parts in any order. @param max_pixels of the whole; larger ones are refused before memory is taken.
/// @throws InputError where a part is missing, twice there, damaged, or of another map.
MergedShards merge_shards(std::span<const std::string> paths, std::uint64_t max_pixels = default_max_pixels);

}  // namespace envmap
