// SCENE PROBE OUTPUT: what 'envmap render --size 16 --method raycast' writes.
#include <envmap/scenes.h>

#include <iostream>

int main(int, char** argv) try {
  using namespace envmap;
  const Source probe = read(argv[2]);
  const RenderedMap made = render(argv[1], {.size = 16, .method = DrawMethod::raycast}, &probe.map);
  write(argv[3], made.map);
} catch (const envmap::Error& e) {
  std::cerr << e.what() << '\n';
  return 1;
}
