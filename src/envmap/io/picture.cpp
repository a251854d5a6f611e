#include "envmap/io/picture.h"

#include <algorithm>
#include <filesystem>
#include <vector>

#include "envmap/io/image_writer.h"
#include "envmap/io/output_file.h"
#include "envmap/io/srgb.h"

namespace envmap {
namespace {

// Without the dot.
std::string extension(const std::string& path, const PictureOptions& options) {
  if (!options.format.empty()) return options.format;
  const std::string of_name = std::filesystem::path(path).extension().string();
  return path == "-" ? "png" : of_name.substr(std::min<std::size_t>(1, of_name.size()));
}

bool holds_floats(const std::string& extension) { return extension == "exr" || extension == "hdr"; }

}  // namespace

bool is_picture(const std::string& path, const PictureOptions& options) {
  const std::string kind = extension(path, options);
  return holds_floats(kind) || kind == "png" || kind == "jpg";
}

bool is_linear_picture(const std::string& path, const PictureOptions& options) {
  return holds_floats(extension(path, options));
}

void write_picture(const std::string& path, int width, std::span<const Colour> pixels, const PictureOptions& options) {
  if (is_linear_picture(path, options)) return write_stored(path, width, pixels, Depth::single, options);
  std::vector<Colour> encoded(pixels.begin(), pixels.end());
  show(encoded, options.display);
  encode_srgb(encoded);
  write_stored(path, width, encoded, Depth::uint8, options);
}

void write_stored(const std::string& path, int width, std::span<const Colour> pixels, Depth depth,
                  const PictureOptions& options) {
  const int height = int(pixels.size()) / width;
  OutputFile file(path, options.commit);
  const ImageWriter writer =
      make_writer(file, path, extension(path, options), {.levels = {{width, height}}, .depth = depth});
  writer.write(0, 0, height, pixels);
  writer.close();
  file.commit();
}

}  // namespace envmap
