#include "envmap/base/bounds.h"

#include <fmt/format.h>

#include "envmap/base/error.h"

namespace envmap {

void check(const Bounds& range, double value) {
  if (!range.hold(value)) throw UsageError(range, value);
}

UsageError::UsageError(const Bounds& range, double value)
    : ErrorOf(fmt::format("{} must be {:.7g} to {:.7g}, not {:.7g}", range.field, range.least, range.most, value)),
      range_(range) {}

}  // namespace envmap
