/// @file
/// The colours of a file as those of the map in memory.
#pragma once

#include "envmap/io/images/open_image.h"
#include "envmap/io/metadata.h"
#include "envmap/io/read.h"

namespace envmap {

/// What a file says of its colours; says to the image whether values are to be decoded where it is read.
/// @throws UsageError where the format says it, and the options name another space.
ClaimedSpace claimed_space(Image& image, const Metadata& recorded, const ColourOptions& options);

/// Sets what a source tells of its file's colours, and what became of the file's claims. @throws as claimed_space().
void record_colours(Source& source, Image& image, const Metadata& recorded, const ColourOptions& options);

/// Whether two files say the same of their colours.
bool same(const ClaimedSpace& a, const ClaimedSpace& b);

/// Turns all levels, of which the flaws are settled, into the working space, and says which primaries the map has now,
/// where it was not taken for linear Rec.709 all along. Colours outside of that space go to its border,
/// which a note counts.
void into_working(Source& source, const ColourTransform& transform, const ColourOptions& options);

/// How read() comes from what the file holds to the working space.
ColourTransform colours_of(const Source& source, const ColourOptions& options);

}  // namespace envmap
