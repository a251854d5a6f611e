/// @file
/// Where the texels of a level lie: in memory, or in a scratch file that is mapped into it.
#pragma once

#include <cstddef>

#include "envmap/base/export.h"
#include "envmap/maths/vector.h"

namespace ENVMAP_EXPORT envmap {

/// An array of colours, all 0 at first.
///
/// With a limit it is a file without a name in $TMPDIR, or /var/tmp, of which the system keeps in memory what is in
/// use: all code that reads and writes texels works on it as it is.
/// The limit holds where trim() is called often enough.
class Storage {
 public:
  /// @param limit bytes of memory that the whole process may take; 0 for none, and no scratch file.
  /// @throws OutputError where the folder cannot hold the file, std::bad_alloc.
  Storage(std::size_t count, std::size_t limit);
  Storage(const Storage& other);
  Storage(Storage&& other) noexcept;
  Storage& operator=(Storage other) noexcept;
  ~Storage();

  [[nodiscard]] Colour* data() { return data_; }
  [[nodiscard]] const Colour* data() const { return data_; }
  [[nodiscard]] std::size_t limit() const { return limit_; }

  /// Leaves the texels to the scratch file, if there is one, where the process has come near the limit. May be called
  /// while others read and write them.
  void trim() const;

 private:
  Colour* data_ = nullptr;
  std::size_t count_ = 0, limit_ = 0;
};

}  // namespace envmap
