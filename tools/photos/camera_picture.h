// convert --to perspective, fisheye or cylinder: a picture of a map, which is no map.
#pragma once

#include <optional>
#include <string>

#include "cli/report.h"
#include "envmap/io/images/picture.h"
#include "envmap/operate/photograph.h"
#include "maps/colour_and_light_options.h"
#include "maps/rotation_options.h"

namespace tools {

struct PhotographJob {
  std::string input, output, format;
  envmap::ReadOptions read;
  GradeOptions grade;
  envmap::PhotographOptions photograph;  // `field`, `width`, `height` and `rotation` are those of the job.
  std::optional<Turn> turn;
  std::optional<double> field;       // Degrees; absent: 60, of a fisheye 180, of a cylinder 90.
  std::optional<int> width, height;  // Absent: 4 by 3, a square, or once round; 480 high.
  std::optional<envmap::Display> display;
};

// Reads, takes the picture and writes it. @return the exit status.
int take_photograph(const PhotographJob& job, Report& report);

}  // namespace tools
