#include <fmt/format.h>

#include <sstream>

#include "cli/command_line.h"
#include "cli/report.h"
#include "commit.h"
#include "envmap/base/error.h"
#include "envmap/scenes/render/context.h"

namespace tools {

std::string version_text() {
  const std::string commit = ENVMAP_COMMIT;
  return fmt::format("envmap {}{}\nwith {}", ENVMAP_VERSION_TEXT, commit.empty() ? "" : " (" + commit + ")",
                     ENVMAP_LIBRARIES);
}

std::string renderer_text() try {
  return "draws with " + envmap::Context(envmap::ContextKind::automatic).renderer();
} catch (const envmap::RendererError& e) {
  return std::string("draws with raycast alone: ") + e.what();
}

std::string version_json() {
  Report report;
  report.put("envmap", ENVMAP_VERSION_TEXT);
  const std::string commit = ENVMAP_COMMIT;
  report.put("commit", commit.empty() ? ReportValue(nullptr) : ReportValue(commit));
  std::istringstream libraries(ENVMAP_LIBRARIES);
  for (std::string name, version; libraries >> name >> version;) {
    if (version.ends_with(',')) version.pop_back();
    report.put_word("libraries", name, version);
  }
  try {
    report.put("renderer", envmap::Context(envmap::ContextKind::automatic).renderer());
  } catch (const envmap::RendererError&) {
    report.put("renderer", nullptr);
  }
  return report.text();
}

}  // namespace tools
