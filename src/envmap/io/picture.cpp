#include "envmap/io/picture.h"

#include <OpenImageIO/imageio.h>
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <vector>

#include "envmap/error.h"
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
  if (holds_floats(path)) return write_encoded(path, width, pixels);
  std::vector<Colour> encoded(pixels.begin(), pixels.end());
  for (Colour& c : encoded) c = glm::clamp(c, 0.0F, 1.0F);
  encode_srgb(encoded);
  write_encoded(path, width, encoded);
}

void write_encoded(const std::string& path, int width, std::span<const Colour> pixels) {
  const bool floats = holds_floats(path);
  OutputFile file(path);
  OIIO::Filesystem::IOProxy* proxy = &file;
  OIIO::ImageSpec spec(width, static_cast<int>(pixels.size()) / width, 3,
                       floats ? OIIO::TypeDesc::FLOAT : OIIO::TypeDesc::UINT8);
  spec.attribute("oiio:ColorSpace", floats ? "Linear" : "sRGB");
  spec.attribute("oiio:ioproxy", OIIO::TypeDesc::PTR, &proxy);
  const auto output = OIIO::ImageOutput::create(extension(path).substr(1));
  if (!output || !output->open("x" + extension(path), spec) ||
      !output->write_image(OIIO::TypeDesc::FLOAT, pixels.data()) || !output->close())
    throw OutputError(fmt::format("{}: not written: {}", path, output ? output->geterror() : "no writer for this type"));
  file.commit();
}

}  // namespace envmap
