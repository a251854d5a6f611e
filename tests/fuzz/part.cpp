#include <cstdlib>
#include <fstream>
#include <string>
#include <string_view>
#include <vector>

#include "envmap/base/error.h"
#include "envmap/io/shard.h"
#include "targets.h"

using namespace envmap;

void fuzz_part(Bytes data) {
  constexpr std::string_view mark = "\x76\x2f\x31\x01";
  std::string_view left(reinterpret_cast<const char*>(data.data()), data.size());
  std::vector<std::string> parts;
  while (!left.empty() && parts.size() < 4) {
    const std::string_view one = left.substr(0, left.find(mark, 1));
    parts.push_back("fuzz_part-" + std::to_string(parts.size()) + ".exr");
    std::ofstream(parts.back(), std::ios::binary) << one;
    left.remove_prefix(one.size());
  }
  if (parts.empty()) return;
  try {
    const MergedShards joined = merge_shards(parts);
    if (joined.map.base().height() < 1) std::abort();
  } catch (const InputError&) {  // Its words become printable where the program tells them.
  }
}
