// A plot of what `tradeoff` measured.
#pragma once

#include <span>
#include <string>

#include "drawing/canvas.h"

namespace tools {

struct PlotPoint {
  double x, y;  // Cost, above 0, and error; what has none stands on a line of its own.
  std::string series, label;
  bool front;
};

// Points on logarithmic axes, those of the front joined. All of the front are labelled, and others where there is room;
// series differ in their marks, not in colour alone.
Drawing plot(std::span<const PlotPoint> points, const std::string& title, const std::string& x_axis,
             const std::string& y_axis);

}  // namespace tools
