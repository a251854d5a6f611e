// Any bytes, read as a file and from standard input: they are a map, or an InputError or UsageError comes out.
// The last byte chooses the options; every format can do without it, so seeds and finds are plain image files.
#include "envmap/io/read.h"

#include <sys/resource.h>
#include <tbb/global_control.h>
#include <unistd.h>

#include <cstdlib>
#include <fstream>
#include <string>

#include "envmap/base/error.h"

using namespace envmap;

namespace {

ReadOptions options(unsigned choice) {
  ReadOptions o;
  o.flaws = choice & 2 ? FlawPolicy::repair : FlawPolicy::refuse;
  o.ignore_envmap_attribute = choice & 4;
  o.drop_channels = !(choice & 8);
  o.all_levels = choice & 64;
  if (choice & 16) o.projection = all_projections[(choice >> 5) % std::size(all_projections)];
  return o;
}

void try_to_read(const std::string& path, const ReadOptions& o) {
  try {
    const Source source = read(path, o);
    if (source.map.base().height() < 1) std::abort();
  } catch (const InputError& e) {
    for (const unsigned char c : std::string(e.what()))
      if (c < ' ') std::abort();  // One line, harmless to a terminal.
  } catch (const UsageError&) {
  }
}

}  // namespace

// OpenEXR takes what memory a header asks for, 2 GiB for a name, before it sees the file's end; here it gets none.
extern "C" int LLVMFuzzerInitialize(int*, char***) {
  constexpr rlimit memory{std::size_t{3} << 29, std::size_t{3} << 29};
  return ::setrlimit(RLIMIT_AS, &memory);
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const tbb::global_control one_thread(tbb::global_control::max_allowed_parallelism, 1);

  // Written always: a crash inside malloc can block libFuzzer's own report. Targa alone goes by the name.
  const std::string bytes(reinterpret_cast<const char*>(data), size), file = "fuzz_read.tga";
  std::ofstream(file, std::ios::binary) << bytes;

  const unsigned choice = size > 0 ? data[size - 1] : 0;
  if (choice & 1) {
    // A pipe holds 64 kB, more than any input here.
    int pipe[2];
    if (::pipe(pipe) != 0 || ::write(pipe[1], bytes.data(), bytes.size()) < 0) std::abort();
    ::close(pipe[1]);
    ::dup2(pipe[0], STDIN_FILENO);
    ::close(pipe[0]);
    try_to_read("-", options(choice));
  } else {
    try_to_read(file, options(choice));
  }
  return 0;
}
