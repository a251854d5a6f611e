// libFuzzer's side of a target: its name is FUZZ_TARGET.
#include <sys/resource.h>
#include <tbb/global_control.h>

#include <cstdint>

#include "targets.h"

// What a header promises must be bounded by what the file holds. The address sanitizer takes terabytes: its runs have
// libFuzzer's own limits.
extern "C" int LLVMFuzzerInitialize(int*, char***) {
#if __has_feature(address_sanitizer)
  return 0;
#else
  constexpr rlimit memory{std::size_t{3} << 29, std::size_t{3} << 29};
  return ::setrlimit(RLIMIT_AS, &memory);
#endif
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const tbb::global_control one_thread(tbb::global_control::max_allowed_parallelism, 1);
  fuzz(FUZZ_TARGET, std::as_bytes(std::span(data, size)));
  return 0;
}
