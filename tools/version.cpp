#include <fmt/format.h>

#include "command.h"
#include "commit.h"

namespace tools {

std::string version_text() {
  const std::string commit = ENVMAP_COMMIT;
  return fmt::format("envmap {}{}\nwith {}", ENVMAP_VERSION, commit.empty() ? "" : " (" + commit + ")", ENVMAP_LIBRARIES);
}

}  // namespace tools
