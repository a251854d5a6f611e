// PROBE ENGINE FOLDER: what 'envmap bake --quality draft' writes.
#include <envmap/envmap.h>

#include <iostream>

int main(int, char** argv) try {
  using namespace envmap;
  Source probe = read(argv[1]);
  const BakeOptions options{.quality = qualities[0],
                            .write = {.source_depth = probe.depth, .provenance = probe.provenance}};
  bake(std::move(probe.map), engine_named(argv[2]), argv[3], options);
} catch (const envmap::Error& e) {
  std::cerr << e.what() << '\n';
  return 1;
}
