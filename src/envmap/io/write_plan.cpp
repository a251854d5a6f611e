#include "envmap/io/write_plan.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <filesystem>
#include <span>
#include <string_view>
#include <vector>

#include "envmap/base/error.h"
#include "envmap/io/files/face_names.h"
#include "envmap/io/files/output_file.h"
#include "envmap/io/formats/openexr.h"
#include "envmap/io/images/detect_layout.h"
#include "envmap/io/metadata.h"

namespace envmap {

std::string extension(const std::string& path, const WriteOptions& options) {
  if (!options.format.empty()) return extension_of("*." + options.format);
  return path == "-" ? "exr" : extension_of(path);
}

Depth choose_depth(const FileFormat& format, const WriteOptions& options) {
  const std::span<const Depth> held = format.depths;
  if (options.depth) {
    if (std::ranges::find(held, *options.depth) != held.end()) return *options.depth;
    std::vector<std::string_view> names;  // A view of them is beyond clang 14 with GCC's library.
    for (const Depth d : held) names.push_back(name(d));
    throw UsageError(fmt::format("{} files cannot store {}: choose {}", format.title, name(*options.depth),
                                 fmt::join(names, " or ")));
  }
  // What came out of blocks or RGBD are halves; blocks are written where they are asked for.
  const Depth before = options.source_depth;
  const bool lossy = before == Depth::bc6h || before == Depth::uastc_hdr || before == Depth::rgbd;
  const Depth source = lossy ? Depth::half : before;
  if (std::ranges::find(held, source) != held.end()) return source;
  for (const Depth d : held)
    if (d >= source) return d;
  return held.back();
}

void check_space(const std::string& path, const FileFormat& format, Depth depth, const WriteOptions& options) {
  const ColourOptions& colour = options.colour;
  if (colour.space.empty()) return;
  const bool linear = curve_of(colour.config, colour.space) == Curve::linear;
  if (!linear && !format.can(FileFormat::encoded_values))
    throw UsageError(path, fmt::format("{} files hold linear values and cannot say that they are encoded: choose a "
                                       "linear space, or .exr",
                                       format.title));
  if (!linear && !is_integer(depth) && !options.encoded)
    throw UsageError(path,
                     fmt::format("{} is encoded, and programs take the values of {} files for linear", colour.space,
                                 format.title),
                     Remedy::choose_linear);
  const std::optional<Primaries> stored = primaries_of(colour.config, colour.space);
  if (format.names && !(stored && format.names(*stored)))
    throw UsageError(
        path, fmt::format("{} has no number for the primaries of {}: choose ACEScg or another standard space, or .exr",
                          format.title, colour.space));
}

namespace {

// A mark that stands for nothing, such as {fcae}, would stay in the name.
void check_marks(const std::string& path) {
  for (const std::string_view mark : {face_mark, half_mark, level_mark})
    if (path.find(mark) != path.rfind(mark)) throw UsageError(path, fmt::format("{} stands in it twice", mark));
  const std::string name = std::filesystem::path(path).filename().string();
  for (std::size_t at = name.find('{'); at != name.npos; at = name.find('{', at + 1)) {
    const std::string mark = name.substr(at, name.find('}', at) - at + 1);
    const bool is_word =
        mark.size() > 2 && mark.back() == '}' &&
        std::ranges::all_of(mark.substr(1, mark.size() - 2), [](unsigned char c) { return c >= 'a' && c <= 'z'; });
    if (is_word && mark != face_mark && mark != half_mark && mark != level_mark)
      throw UsageError(path, mark + " stands for nothing here: use {face}, {half} or {level}");
  }
}

Layout choose_layout(const std::string& path, const FileFormat& format, const WriteOptions& options, Projection p) {
  if (p != Projection::cube) {
    if (format.cubes_alone)
      throw UsageError(path, fmt::format("{} files hold cube maps; this is a {} map", format.title, name(p)),
                       Remedy::make_cube);
    if (options.layout)
      throw UsageError(fmt::format("a layout is for cube maps; this is a {} map", name(p)), Remedy::leave_out_layout);
    if (has_face(path) && p != projection_of_faces(path))
      throw UsageError(fmt::format("{} in a file name is for {} maps; this is a {} map",
                                   has_half(path) ? half_mark : face_mark, name(projection_of_faces(path)), name(p)),
                       has_half(path) ? Remedy::none : Remedy::make_cube);
    return has_half(path) ? Layout::files : default_layout(p);
  }
  if (has_half(path))
    throw UsageError("{half} in a file name is for paraboloid maps; of a cube {face} writes six files");
  if (format.texture) {
    if (options.layout || has_face(path))
      throw UsageError(path, fmt::format("{} files hold cube faces as the APIs define them", format.title),
                       options.layout ? Remedy::leave_out_layout : Remedy::leave_out_face);
    return Layout::api;
  }
  if (options.layout == Layout::files && !has_face(path))
    throw UsageError("a file for each face: put {face} into the file name, for px, nx, py, ny, pz, nz");
  if (has_face(path)) {
    if (options.layout && options.layout != Layout::files)
      throw UsageError("{face} in a file name writes six files", Remedy::leave_out_layout);
    return Layout::files;
  }
  return options.layout.value_or(Layout::column);
}

void check_compression(const std::string& path, const FileFormat& format, const std::string& wanted) {
  if (wanted.empty()) return;
  if (!format.can(FileFormat::compression)) throw UsageError(path, "a compression is chosen for .exr files alone");
  const auto colon = wanted.find(':');
  const std::string kind = wanted.substr(0, colon), level = colon == std::string::npos ? "" : wanted.substr(colon + 1);
  const bool zip = kind.starts_with("zip"), dwa = kind.starts_with("dwa");
  const bool number = !level.empty() && level.size() < 6 && level.find_first_not_of("0123456789") == std::string::npos;
  const int n = number ? std::stoi(level) : 0;
  if (!is_compression(kind) || (colon != std::string::npos && !(zip && n >= 1 && n <= 9) && !(dwa && n >= 1)))
    throw UsageError(
        fmt::format("compression {}: is none of none, rle, zips, zip, piz, pxr24, b44, b44a, dwaa, dwab, "
                    "zip:1 to zip:9, dwaa:N and dwab:N",
                    wanted));
}

}  // namespace

OutputPlan plan_output(const std::string& path, const WriteOptions& options, Projection projection, bool levels) {
  check_enumerator("projection", projection);
  check_enumerator("source_depth", options.source_depth);
  if (options.depth) check_enumerator("depth", *options.depth);
  if (options.layout) check_cube_layout(*options.layout);
  for (const auto& [key, text] : options.facts)
    if (!is_word(key) || !is_word(text))
      throw UsageError(fmt::format("facts must be words without spaces, not '{}': '{}'", key, text));
  std::error_code error;
  if (path != "-" && std::filesystem::is_directory(path, error))
    throw OutputError(path, "is a folder: give a file name");
  check_marks(path);
  const std::string ext = extension(path, options);
  const FileFormat* format = format_with_extension(ext);
  if (!format) {
    const std::string known = writable_extensions(projection, levels && !has_level(path));
    if (ext.empty()) throw UsageError(path, "has no file type: end the name in " + known, Remedy::choose_format);
    throw UsageError(path, fmt::format("cannot write .{} files: try {}", ext, known));
  }
  if (const FileFormat* named = format_with_extension(extension_of(path)); path != "-" && named && named != format)
    throw UsageError(path, fmt::format("is named as a {} file, and the format asked for is {}: make the two agree",
                                       named->title, format->title));
  const Depth depth = choose_depth(*format, options);
  if (!is_integer(format->depths.front())) check_space(path, *format, format->depths.front(), options);
  const Layout layout = choose_layout(path, *format, options, projection);
  check_faces(path, options.faces);
  const FaceFiles names = face_files(options.faces);
  if (options.openexr_envmap &&
      (!format->can(FileFormat::envmap_mark) || (layout != Layout::column && projection != Projection::latlong)))
    throw UsageError(path, "OpenEXR's envmap attribute is for .exr files of latlong maps and of cubes in a column");
  if (options.border > 0 && !is_octahedral(projection))
    throw UsageError(fmt::format("a border is for octahedral and equal-area maps, not for a {} map", name(projection)));
  if (!options.rows.empty() && (!format->can(FileFormat::row_range) || layout == Layout::files || has_level(path) ||
                                options.openexr_envmap || options.border > 0))
    throw UsageError(path, "a part of a map is one .exr file, without borders: merge writes other formats");
  check_compression(path, *format, options.compression);
  if (options.zstd && !format->can(FileFormat::zstd)) throw UsageError(path, "Zstandard is for .ktx2 files");
  if (levels && !has_level(path) && (!format->levels || layout == Layout::files))
    throw UsageError(path, fmt::format("{} one level: put {{level}} into the file name",
                                       layout == Layout::files ? "files of one face hold" : "." + ext + " files hold"));
  for (const std::string& file : files_named(path, 1, names)) require_folder_of(file);
  return {ext, *format, depth, layout, names};
}

}  // namespace envmap
