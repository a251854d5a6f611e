/// @file
/// The levels of a map as the images of one file.
#pragma once

#include <span>
#include <vector>

#include "envmap/map/atlas.h"

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

}  // namespace envmap
