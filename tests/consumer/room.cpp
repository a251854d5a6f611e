// SCENE PROBE OUTPUT PICTURE: what 'envmap render --size 16 --method raycast' and 'envmap view --method raycast' write.
#include <envmap/scenes.h>

#include <iostream>

int main(int, char** argv) try {
  using namespace envmap;
  const Source probe = read(argv[2]);
  const RenderedMap made = render(argv[1], {.size = 16, .method = DrawMethod::raycast}, &probe.map);
  write(argv[3], made.map);
  const ViewedScene seen = view(argv[1], {.width = 32, .height = 24, .method = ViewMethod::raycast}, &probe.map);
  write_picture(argv[4], seen.width, seen.radiance);
} catch (const envmap::Error& e) {
  std::cerr << e.what() << '\n';
  return 1;
}
