#include "envmap/io/images/image_writer.h"

#include "envmap/base/error.h"
#include "envmap/io/formats/file_format.h"
#include "envmap/io/formats/openimageio_module.h"

namespace envmap {
namespace {

template <class F>
auto naming(const std::string& path, F&& action) {
  try {
    return action();
  } catch (const OutputError& e) {
    throw OutputError(path, std::string("not written: ") + e.what());
  }
}

}  // namespace

ImageWriter make_writer(OutputFile& file, const std::string& path, const std::string& extension,
                        const ImagePlan& plan) {
  const ImageWriter writer = naming(path, [&] {
    const FileFormat* format = format_with_extension(extension);
    return format && format->create ? format->create(file, plan) : formats().create(file, extension, plan);
  });
  return {.write =
              [path, writer](int level, int begin, int end, std::span<const Colour> rows) {
                naming(path, [&] { writer.write(level, begin, end, rows); });
              },
          .close = [path, writer] { naming(path, writer.close); }};
}

}  // namespace envmap
