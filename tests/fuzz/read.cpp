#include "envmap/io/read.h"

#include <unistd.h>

#include <cstdlib>
#include <fstream>
#include <string>

#include "envmap/base/error.h"
#include "targets.h"

using namespace envmap;

namespace {

ReadOptions options(unsigned choice) {
  ReadOptions o;
  o.flaws = choice & 2 ? FlawPolicy::repair : FlawPolicy::refuse;
  o.ignore_envmap_attribute = choice & 4;
  o.drop_channels = !(choice & 8);
  o.all_levels = choice & 64;
  o.apply_pose = choice & 128;
  if (choice & 16) o.projection = all_projections[(choice >> 5) % std::size(all_projections)];
  return o;
}

void try_to_read(const std::string& path, const ReadOptions& o) {
  try {
    const Source source = read(path, o);
    if (source.map.base().height() < 1) std::abort();
  } catch (const InputError& e) {
    expect_harmless(e.what());
  } catch (const UsageError&) {
  }
}

}  // namespace

void fuzz_read(Bytes data) {
  // Written always: a crash inside malloc can block libFuzzer's own report. Targa alone goes by the name.
  const std::string bytes(reinterpret_cast<const char*>(data.data()), data.size()), file = "fuzz_read.tga";
  std::ofstream(file, std::ios::binary) << bytes;

  const unsigned choice = data.empty() ? 0 : unsigned(data.back());
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
}
