#include "envmap/io/write_table.h"

#include <OpenImageIO/imageio.h>
#include <fmt/format.h>

#include <filesystem>

#include "envmap/error.h"
#include "envmap/io/output_file.h"

namespace envmap {

void check_table(const std::string& path) {
  const std::string ext = std::filesystem::path(path).extension().string();
  if (ext != ".exr" && ext != ".hdr" && ext != ".tif" && ext != ".tiff")
    throw UsageError(path + ": a table is an .exr, .hdr or .tif");
  const std::filesystem::path parent = std::filesystem::path(path).parent_path();
  std::error_code error;
  if (!parent.empty() && !std::filesystem::is_directory(parent, error))
    throw OutputError(fmt::format("{}: no such folder: {}", path, parent.string()));
}

void write_table(const std::string& path, std::span<const Colour> texels, int size) {
  check_table(path);
  const std::string name = "x" + std::filesystem::path(path).extension().string();
  OutputFile file(path);
  const std::unique_ptr<OIIO::ImageOutput> output = OIIO::ImageOutput::create(name);
  OIIO::ImageSpec spec(size, size, 3, OIIO::TypeDesc::FLOAT);
  spec.attribute("DateTime", "");  // OpenImageIO would write the time of day.
  OIIO::Filesystem::IOProxy* proxy = &file;
  spec.attribute("oiio:ioproxy", OIIO::TypeDesc::PTR, &proxy);
  if (!output || !output->open(name, spec) || !output->write_image(OIIO::TypeDesc::FLOAT, texels.data()) || !output->close())
    throw OutputError(fmt::format("{}: not written: {}", path, output ? output->geterror() : "no writer"));
  file.commit();
}

}  // namespace envmap
