/// @file
/// How written files appear.
#pragma once

#include "envmap/base/export.h"

namespace ENVMAP_EXPORT envmap {

struct CommitOptions {
  bool sync = false;        ///< Only once their bytes are on the disk, and their names before the call returns.
  bool if_changed = false;  ///< Where the file that is there holds the same bytes it stays, with its time.
  /// Replaces a file that is read-only: without any write bit, as version control marks files.
  bool force = false;
};

}  // namespace envmap
