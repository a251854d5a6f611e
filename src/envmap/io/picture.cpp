#include "envmap/io/picture.h"

#include <algorithm>
#include <filesystem>
#include <vector>

#include "envmap/io/image_writer.h"
#include "envmap/io/output_file.h"
#include "envmap/io/srgb.h"

namespace envmap {
namespace {

std::string extension(const std::string& path) { return std::filesystem::path(path).extension().string(); }
bool holds_floats(const std::string& path) { return extension(path) == ".exr" || extension(path) == ".hdr"; }

}  // namespace

bool is_picture(const std::string& path) {
  return holds_floats(path) || extension(path) == ".png" || extension(path) == ".jpg";
}

void write_picture(const std::string& path, int width, std::span<const Colour> pixels) {
  if (holds_floats(path)) return write_stored(path, width, pixels, Depth::single);
  std::vector<Colour> encoded(pixels.begin(), pixels.end());
  for (Colour& c : encoded) c = glm::clamp(c, 0.0F, 1.0F);
  encode_srgb(encoded);
  write_stored(path, width, encoded, Depth::uint8);
}

void write_stored(const std::string& path, int width, std::span<const Colour> pixels, Depth depth) {
  const int height = static_cast<int>(pixels.size()) / width;
  OutputFile file(path);
  const ImageWriter writer =
      make_writer(file, path, extension(path).substr(1), {.levels = {{width, height}}, .depth = depth});
  writer.write(0, 0, height, pixels);
  writer.close();
  file.commit();
}

}  // namespace envmap
