// --shard I/N: one part of a command's output, which `envmap merge` joins with the others.
#pragma once

#include <optional>
#include <string>

#include "cli/options.h"
#include "envmap/io/shard.h"

namespace tools {

struct Shard {
  std::optional<envmap::PartNumber> part;
  std::string command;
  const Options* options = nullptr;  ///< What was asked of the command.
};

void add_shard(Options& o, std::string_view command, Shard& shard);

/// How to write the output: one part of it where that was asked for. @param source what the output is made of: with the
/// command's options it tells the parts of one map from those of another.
envmap::WriteOptions part_or_whole(const Shard& shard, const envmap::WriteOptions& whole, const envmap::Rows& rows,
                                   const std::string& source);

/// A word that stands for a source: its texels and its frame.
std::string digest(const envmap::EnvironmentMap& source);

}  // namespace tools
