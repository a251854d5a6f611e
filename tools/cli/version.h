// What --version says beyond the program itself.
#pragma once

#include <string>

namespace tools {

// What draws with --context auto, or why nothing does.
std::string renderer_text();

}  // namespace tools
