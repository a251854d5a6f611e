/// @file
/// What two readers of the same file are compared by.
#pragma once

#include <gtest/gtest.h>

#include <vector>

#include "envmap/io/images/image_reader.h"

namespace envmap {

/// Under the address sanitizer OpenImageIO takes 70 times as long. There a second reader of ours is the judge, and only
/// memory is looked at: values are compared in the optimised build.
#ifdef __SANITIZE_ADDRESS__
inline constexpr bool openimageio_judges = false;
#else
inline constexpr bool openimageio_judges = true;
#endif

/// Rows [begin, end) of a reader's only part, `count` channels from the first named on.
inline std::vector<float> texels(const ImageReader& reader, int begin, int end, int first, int count) {
  std::vector<float> out(std::size_t(reader.facts.width) * std::size_t(end - begin) * std::size_t(count));
  reader.read(0, begin, end, first, count, out);
  return out;
}

inline std::vector<float> texels(const ImageReader& reader) {
  return texels(reader, 0, reader.facts.height, 0, int(reader.facts.channels.size()));
}

inline void expect_same_facts(const ImageFacts& is, const ImageFacts& wanted) {
  EXPECT_EQ(is.width, wanted.width);
  EXPECT_EQ(is.height, wanted.height);
  EXPECT_EQ(is.depth, wanted.depth);
  EXPECT_EQ(is.encoded, wanted.encoded);
  EXPECT_EQ(is.names, wanted.names);
  EXPECT_EQ(is.channels, wanted.channels);
}

}  // namespace envmap
