#include "envmap/io/write_table.h"

#include "envmap/base/error.h"
#include "envmap/io/files/output_file.h"
#include "envmap/io/formats/file_format.h"
#include "envmap/io/images/picture.h"
#include "envmap/io/metadata.h"

namespace envmap {

void check_table(const std::string& path) {
  const FileFormat* format = format_with_extension(extension_of(path));
  if (!format || !format->can(FileFormat::table)) throw UsageError(path, "a table is an .exr, .hdr or .tif");
  require_folder_of(path);
}

void write_table(const std::string& path, std::span<const Colour> texels, int size, const std::string& lobe,
                 const CommitOptions& commit) {
  check_table(path);
  write_stored(path, size, texels, Depth::single, {.commit = commit},
               attributes({.facts = {{std::string(table_fact), lobe}}}));
}

}  // namespace envmap
