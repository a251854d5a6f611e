#include "envmap/base/bounds.h"

#include <fmt/format.h>

#include "envmap/base/check_length.h"
#include "envmap/base/enumerators.h"
#include "envmap/base/error.h"

namespace envmap {

void check_range(const Bounds& range, double value) {
  if (!range.hold(value)) throw UsageError(range, value);
}

void refuse_enumerator(std::string_view field, long long value, std::size_t count) {
  throw UsageError(fmt::format("{} must be an enumerator, 0 to {}, not {}", field, count - 1, value));
}

void check_length(std::string_view field, std::size_t length, std::size_t wanted) {
  if (length != wanted) throw UsageError(fmt::format("{} must hold {} elements, not {}", field, wanted, length));
}

UsageError::UsageError(const Bounds& range, double value)
    : ErrorOf(fmt::format("{} must be {:.7g} to {:.7g}, not {:.7g}", range.field, range.least, range.most, value)),
      range_(range) {}

}  // namespace envmap
