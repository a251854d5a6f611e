// envmap.read(), write(), encode() and pack().
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <span>

#include "words.h"

namespace envmap_python {
namespace {

namespace py = pybind11;
using namespace py::literals;
using namespace envmap;

std::filesystem::path path_of(const py::object& file) {
  try {
    return file.cast<std::filesystem::path>();
  } catch (const py::cast_error&) {
    throw UsageError("a file is named by a str or an os.PathLike, not by " +
                     py::cast<std::string>(py::type::of(file).attr("__name__")));
  }
}

// Where the bytes are no image, but the name of a file that is there.
bool is_name(std::span<const std::byte> bytes) {
  std::error_code error;
  const std::string name(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  return !name.empty() && name.size() < 4096 && name.find('\0') == name.npos && std::filesystem::exists(name, error);
}

Map read_bytes(std::span<const std::byte> bytes, const ReadOptions& o) try {
  const py::gil_scoped_release others;
  return shared(std::move(read(bytes, o).map));
} catch (const InputError& e) {
  if (!is_name(bytes)) throw;
  throw UsageError("bytes are the contents of a file; these name one: os.fsdecode() makes a name of them");
}

Map read_file(const py::object& file, const std::optional<std::string>& projection,
              const std::optional<std::string>& layout, const std::string& faces,
              const std::optional<std::string>& forward, int level, bool all_levels, bool repair, bool drop_channels,
              const std::string& space, const std::string& working, std::optional<double> headroom) {
  ReadOptions o;
  if (projection) o.projection = projection_of(*projection);
  if (layout) o.layout = layout_of(*layout);
  if (forward) o.forward = forward_of(*forward);
  o.faces = faces;
  o.level = level, o.all_levels = all_levels, o.drop_channels = drop_channels;
  o.flaws = repair ? FlawPolicy::repair : FlawPolicy::refuse;
  o.colour.space = space, o.colour.working = working;
  o.choice.headroom = headroom;
  if (PyObject_CheckBuffer(file.ptr())) {
    const py::buffer_info bytes = py::reinterpret_borrow<py::buffer>(file).request();
    if (bytes.ndim != 1 || bytes.itemsize != 1 || bytes.strides[0] != 1) throw UsageError("a file in memory is bytes");
    return read_bytes({static_cast<const std::byte*>(bytes.ptr), std::size_t(bytes.size)}, o);
  }
  const std::string path = path_of(file).string();
  const py::gil_scoped_release others;
  return shared(std::move(read(path, o).map));
}

WriteOptions write_options(const std::optional<std::string>& depth, const std::optional<std::string>& layout,
                           const std::string& format, const std::string& compression, bool clamp, bool zstd,
                           const Facts& facts) {
  WriteOptions o{.format = format, .clamp = clamp, .compression = compression, .zstd = zstd, .facts = facts};
  if (depth) o.depth = depth_of(*depth);
  if (layout) o.layout = layout_of(*layout);
  return o;
}

void write_file(const py::object& file, const GivenMap& given, const std::optional<std::string>& depth,
                const std::optional<std::string>& layout, const std::string& faces, const std::string& format,
                const std::string& compression, bool clamp, bool zstd, const Facts& facts, bool force,
                const py::object& progress) {
  WriteOptions o = write_options(depth, layout, format, compression, clamp, zstd, facts);
  o.commit.force = force;
  o.faces = faces;
  const std::string path = path_of(file).string();
  Reporter(progress).run([&](const Run& r) { return write(path, *given.map, o, r); });
}

py::bytes encode_map(const GivenMap& given, const std::string& format, const std::optional<std::string>& depth,
                     const std::optional<std::string>& layout, const std::string& compression, bool clamp, bool zstd,
                     const Facts& facts, const py::object& progress) {
  const WriteOptions o = write_options(depth, layout, format, compression, clamp, zstd, facts);
  const std::vector<std::byte> bytes = Reporter(progress).run([&](const Run& r) { return encode(*given.map, o, r); });
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

// A level as an array: texels by channels, words of rgb9e5, blocks of bc6h. A view of `bytes`.
py::array packed_level(const PackedMap& map, int level, const py::bytes& bytes) {
  const bool halves = map.format == PixelFormat::rgba16f || map.format == PixelFormat::rgb16f;
  const bool floats = map.format == PixelFormat::rgba32f || map.format == PixelFormat::rgb32f;
  const bool alpha = map.format == PixelFormat::rgba16f || map.format == PixelFormat::rgba32f;
  const PackedMap::Part& part = map.part(level, 0);
  std::vector<py::ssize_t> shape;
  if (map.faces > 1) shape.push_back(map.faces);
  if (map.format == PixelFormat::bc6h)
    shape.insert(shape.end(), {(part.height + 3) / 4, (part.width + 3) / 4, 16});
  else
    shape.insert(shape.end(), {part.height, part.width});
  if (halves || floats) shape.push_back(alpha ? 4 : 3);
  const py::dtype type(halves ? "<f2" : floats ? "<f4" : map.format == PixelFormat::rgb9e5 ? "<u4" : "u1");
  return {type, shape, PyBytes_AS_STRING(bytes.ptr()) + part.offset, bytes};
}

py::list pack_map(const GivenMap& given, const std::string& format, const std::string& orientation, bool clamp,
                  const py::object& progress) {
  static constexpr std::string_view orientations[] = {"graphics-api", "seen-from-inside"};
  const PackOptions o{.format = named<PixelFormat>("format", format, pixel_format_names),
                      .orientation = named<FaceOrientation>("orientation", orientation, orientations),
                      .clamp = clamp};
  const PackedMap packed = Reporter(progress).run([&](const Run& r) { return pack(*given.map, o, r); });
  const py::bytes bytes(reinterpret_cast<const char*>(packed.bytes.data()), packed.bytes.size());
  py::list levels;
  for (int k = 0; k < packed.levels; ++k) {
    levels.append(packed_level(packed, k, bytes));
    levels[std::size_t(k)].attr("setflags")("write"_a = false);
  }
  return levels;
}

}  // namespace

void add_files(py::module_& m) {
  m.def("read", &read_file, "file"_a, py::kw_only(), "projection"_a = py::none(), "layout"_a = py::none(),
        "faces"_a = "", "forward"_a = py::none(), "level"_a = 0, "all_levels"_a = false, "repair"_a = false,
        "drop_channels"_a = false, "space"_a = "", "working"_a = "", "headroom"_a = py::none(),
        document(
            "read",
            "file, *, projection=None, layout=None, faces='', forward=None, level=0, all_levels=False, repair=False, "
            "drop_channels=False, space='', working='', headroom=None",
            "Reads a map of a file, or of a file's bytes. {face} in the name reads six files, which faces names. "
            "headroom "
            "limits the gain map of a JPEG, in stops above white."));
  m.def("write", &write_file, "file"_a, "map"_a, py::kw_only(), "depth"_a = py::none(), "layout"_a = py::none(),
        "faces"_a = "", "format"_a = "", "compression"_a = "", "clamp"_a = false, "zstd"_a = false, "facts"_a = Facts{},
        "force"_a = false, "progress"_a = py::none(),
        document("write",
                 "file, map, *, depth=None, layout=None, faces='', format='', compression='', clamp=False, zstd=False, "
                 "facts={}, force=False, progress=None",
                 "Writes a map with its levels; the file appears whole or not at all. force replaces a file that is "
                 "read-only."));
  m.def("encode", &encode_map, "map"_a, "format"_a, py::kw_only(), "depth"_a = py::none(), "layout"_a = py::none(),
        "compression"_a = "", "clamp"_a = false, "zstd"_a = false, "facts"_a = Facts{}, "progress"_a = py::none(),
        document(
            "encode",
            "map, format, *, depth=None, layout=None, compression='', clamp=False, zstd=False, facts={}, progress=None",
            "The bytes of the file that write() would write. format is an extension, such as 'exr'."));
  m.def("pack", &pack_map, "map"_a, "format"_a = "rgba16f", py::kw_only(), "orientation"_a = "graphics-api",
        "clamp"_a = false, "progress"_a = py::none(),
        document("pack", "map, format='rgba16f', *, orientation='graphics-api', clamp=False, progress=None",
                 "Texels of all levels, ready for upload: an array for each level, the largest first.\n\n"
                 "Formats: rgba16f, rgba32f, rgb16f, rgb32f (height, width, channels); rgb9e5 (height, width) words; "
                 "bc6h (rows, columns, 16) "
                 "bytes of blocks. Cubes have the face first, +X -X +Y -Y +Z -Z, as OpenGL, Vulkan and Direct3D define "
                 "them: a lookup with a "
                 "world direction returns the radiance from there. orientation='seen-from-inside' leaves faces as "
                 "Map.array has them."));
}

}  // namespace envmap_python
