#include "envmap/base/large_pages.h"

#include <sys/mman.h>

#include <cstdint>

namespace envmap {

void ask_for_large_pages(void* data, std::size_t bytes) {
  constexpr std::uintptr_t page = 1 << 21;
  const auto begin = reinterpret_cast<std::uintptr_t>(data), first = (begin + page - 1) / page * page,
             last = (begin + bytes) / page * page;
  // Refused where the system has none, which changes no result.
  if (last > first) ::madvise(static_cast<char*>(data) + (first - begin), last - first, MADV_HUGEPAGE);
}

}  // namespace envmap
