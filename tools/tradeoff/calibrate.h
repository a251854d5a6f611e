// Measures envmap::Costs on this machine.
#pragma once

#include "envmap/base/costs.h"

namespace tools {

// Takes about a minute. Without a renderer the figures of OpenGL stay as they are, with a warning.
envmap::Costs calibrated();

}  // namespace tools
