// --shard I/N: one part of a command's output, which `envmap merge` joins with the others.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "cli/options.h"
#include "envmap/engine/engines.h"
#include "envmap/io/shard.h"

namespace tools {

struct Shard {
  std::optional<envmap::PartNumber> part;
  std::string command;
  const Options* options = nullptr;  ///< What was asked of the command.

  /// The name that the options of the whole must agree with: none for a part, an EXR file whatever the whole is.
  [[nodiscard]] std::string whole(const std::string& output) const { return part ? "-" : output; }
};

void add_shard(Options& o, std::string_view command, Shard& shard);

/// How to write the output: one part of it where that was asked for. @param sizes heights of a face, of each level.
/// @param source what the output is made of: with the command's options it tells the parts of one map from those of
/// another.
envmap::WriteOptions part_or_whole(const Shard& shard, const envmap::WriteOptions& whole, envmap::Projection projection,
                                   std::span<const int> sizes, const std::string& source);
envmap::WriteOptions part_or_whole(const Shard& shard, const envmap::WriteOptions& whole, const envmap::Rows& rows,
                                   const std::string& source);

/// Parts hold the map as it was made, and merge mirrors it: the levels of `mipmap` are made between the two.
void leave_mirror_to_merge(envmap::WriteOptions& part, envmap::MirroredAxis mirror);

/// A word that stands for a source: its texels and its frame.
std::string digest(const envmap::EnvironmentMap& source);

}  // namespace tools
