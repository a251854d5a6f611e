// Photos as inputs of convert: mirror balls anywhere in a picture, fisheyes, one half of a paraboloid map.
#pragma once

#include <optional>
#include <string>

#include "cli/options.h"
#include "cli/report.h"
#include "drawing/contact_sheet.h"
#include "envmap/io/read.h"

namespace tools {

enum class PhotoOf { ball, fisheye, equisolid, half_paraboloid };

struct PhotoOptions {
  std::optional<PhotoOf> of;  // Absent: a map, or a photo cropped to a ball.
  std::string circle, back_circle, picture, back;
  std::optional<double> field;  // Degrees; absent: 180.
};

// The words of --from that name photos. To be called after add_read_options().
void add_photo_words(Options& options, PhotoOptions& photo, envmap::ReadOptions& read);
// --circle, --back-circle, --circle-picture and --back.
void add_circle(Options& options, PhotoOptions& photo);

// Settles what the input is. @throws UsageError where options contradict each other.
void resolve_photo_options(PhotoOptions& photo, const envmap::ReadOptions& read);

// A photo as a map.
struct PhotoSource {
  envmap::Source source;
  std::optional<Picture> circle;  // Of --circle-picture, to be written with the map.
};

// Says that a photo of integers ends at white, if it does.
void tell_range(const std::string& path, const envmap::Source& photo);

// Says which circle was found, and how much of the sphere the photo shows.
PhotoSource read_photo(const std::string& path, const PhotoOptions& photo, const envmap::ReadOptions& read,
                       Report& report);

void write_circle(const PhotoOptions& photo, const Picture& circle);

}  // namespace tools
