#include "envmap/io/write_table.h"

#include <fmt/format.h>

#include <filesystem>

#include "envmap/base/error.h"
#include "envmap/io/file_format.h"
#include "envmap/io/picture.h"

namespace envmap {

void check_table(const std::string& path) {
  const std::string ext = std::filesystem::path(path).extension().string();
  const FileFormat* format = ext.empty() ? nullptr : format_with_extension(ext.substr(1));
  if (!format || !format->can(FileFormat::table)) throw UsageError(path, "a table is an .exr, .hdr or .tif");
  const std::filesystem::path parent = std::filesystem::path(path).parent_path();
  std::error_code error;
  if (!parent.empty() && !std::filesystem::is_directory(parent, error))
    throw OutputError(path, "no such folder: " + parent.string());
}

void write_table(const std::string& path, std::span<const Colour> texels, int size, const CommitOptions& commit) {
  check_table(path);
  write_stored(path, size, texels, Depth::single, {.commit = commit});
}

}  // namespace envmap
