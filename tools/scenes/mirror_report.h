// What became of mirrors' maps: a line of --verbose for each, and a table of --json over all frames.
#pragma once

#include <vector>

#include "cli/report.h"
#include "envmap/render/mirrors.h"

namespace tools {

// Says it where --verbose is given.
void tell(const envmap::MirrorUpdates& updates, const envmap::Scene& scene, const std::vector<envmap::Mirror>& mirrors);

class MirrorTable {
 public:
  MirrorTable(const envmap::Scene& scene, const std::vector<envmap::Mirror>& mirrors)
      : scene_(scene), mirrors_(mirrors), rows_(mirrors.size()) {}

  void add(const envmap::MirrorUpdates& of_frame);
  // Keys mirrors[] of the report.
  void put(Report& report) const;

 private:
  struct Row {
    int size = 0, drawn = 0, faces = 0, unchanged = 0, unseen = 0;
    double seconds = 0;
  };
  const envmap::Scene& scene_;
  const std::vector<envmap::Mirror>& mirrors_;
  std::vector<Row> rows_;
};

}  // namespace tools
