// Last bits of the C library's functions, which depend on the processor that it finds; for same_bytes.py.
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <initializer_list>

int main() {
  std::uint64_t sum = 0;
  for (int k = 1; k < 20000; ++k) {
    volatile double x = k * 0.0037;
    for (const double y :
         {std::sin(x), std::cos(x), std::exp(x * 0.1), std::log(x), std::atan2(x, 1.7), std::pow(x, 2.4)}) {
      std::uint64_t bits = 0;
      std::memcpy(&bits, &y, sizeof bits);
      sum = sum * 0x9e3779b97f4a7c15U + bits;
    }
  }
  std::printf("%llx %s\n", static_cast<unsigned long long>(sum),
              __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma") ? "avx2" : "");
}
