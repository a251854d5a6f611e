/// @file
/// The levels of a map as the images of one file.
#pragma once

#include <span>
#include <string_view>
#include <vector>

#include "envmap/map/atlas.h"
#include "envmap/map/layout.h"
#include "envmap/map/rows.h"

namespace envmap {

/// Images as large as the formats want them, each side half of the one before and rounded down. Where faces do not fill
/// an image they lie at its top left, which is where OpenEXR's ImfEnvmap.h looks for them, too. (Of Layout::api each
/// face is an image, and there is nothing to fill.)
class MipChain {
 public:
  /// @param levels must outlive this. @param to_one_texel whether the chain is gone on with until the image is one
  /// texel, as EXR has it; an image too small for faces of one texel shows their mean.
  MipChain(std::span<const Rows> levels, Layout layout, bool to_one_texel);
  MipChain(const MipChain&) = delete;

  [[nodiscard]] std::span<const Atlas> atlases() const { return atlases_; }

 private:
  std::vector<Level> more_;
  std::vector<Rows> rows_;  // Of these.
  std::vector<Atlas> atlases_;
};

/// What the attributes of a part that hold key/value pairs of the whole file begin with.
inline constexpr std::string_view pair_prefix = "pair:";

/// Rows of the levels below one another in one image of one face, as wide as the image of level 0: how a part of a
/// chain lies in its file. Shorter rows lie at its left, black beside them.
/// @param levels must outlive the result. @param places how faces lie in the image of each level.
/// @param ranges image rows of each level, level 0's first.
Rows stacked(std::span<const Rows> levels, const Grid& places, std::span<const RowRange> ranges);

}  // namespace envmap
