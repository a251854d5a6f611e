/// @file
/// The rules for levels and mip chains: what write() and pack() take, and all that makes or keeps levels.
#pragma once

#include <cstddef>
#include <span>
#include <string>

#include "envmap/projection/projection.h"

namespace envmap {

/// Of a face of a level, with its border.
struct LevelSize {
  int width, height;
};

/// @throws UsageError where a side is out of its range, or the face is not as wide as its projection has it. Coarser
/// levels of latlong maps round each side by itself, so theirs may have any width.
void check_face_size(Projection projection, const LevelSize& face);

/// How many levels there are from a face of this size down to one texel.
int possible_levels(const LevelSize& base);

/// @param count levels that follow `base`, itself among them. @param path of the file at fault, or empty.
/// @throws UsageError where there are more than possible_levels().
void check_level_count(const LevelSize& base, std::size_t count, const std::string& path = {});

/// @throws UsageError where a level is not half as large as the one before, rounded down and no less than one texel: a
/// chain that was read may round as its writer did. Says nothing of how many there are.
void check_halving(std::span<const LevelSize> levels, const std::string& path = {});

}  // namespace envmap
