// Files: read, write, encode; texels for graphics APIs.
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <span>

#include "words.h"

namespace envmap_python {
namespace {

namespace py = pybind11;
using namespace py::literals;
using namespace envmap;

py::list claims_of(const Source& s) {
  py::list all;
  for (const Claim& c : s.claims) all.append(py::make_tuple(c.name, c.value, std::string(name(c.outcome)), c.reason));
  return all;
}

// What reading found, by the names of envmap.Source.
py::dict facts_of(const Source& s, const std::string& space) {
  return py::dict("format"_a = s.format, "depth"_a = name(s.depth), "layout"_a = name(s.layout),
                  "width"_a = s.image_width, "height"_a = s.image_height, "levels"_a = s.levels, "border"_a = s.border,
                  "border_samples"_a = s.border_samples, "forward_is_assumed"_a = s.forward_is_assumed,
                  "pose_applied"_a = s.pose.has_value(), "space"_a = space.empty() ? words(s.claimed) : space,
                  "white_luminance"_a = s.provenance.white_luminance, "repaired"_a = s.repaired, "facts"_a = s.facts,
                  "claims"_a = claims_of(s), "notes"_a = s.notes, "details"_a = s.details);
}

py::tuple found(Source&& s, const std::string& space) {
  py::dict facts = facts_of(s, space);
  return py::make_tuple(shared(std::move(s.map)), std::move(facts));
}

py::tuple read_file(const std::string& path, const ReadOptions& o, const py::object& progress) {
  return found(run_operation(progress, [=](const Run& run) { return read(path, o, run); }), o.colour.space);
}

// The bytes are copied: a call that a signal ends leaves its task behind.
py::tuple read_bytes(const py::buffer& file, const ReadOptions& o, const py::object& progress) {
  const py::buffer_info bytes = file.request();
  const auto* const first = static_cast<const std::byte*>(bytes.ptr);
  const auto copy = std::make_shared<const std::vector<std::byte>>(first, first + bytes.size * bytes.itemsize);
  return found(run_operation(progress, [=](const Run& run) { return read(*copy, o, run); }), o.colour.space);
}

void write_file(const std::string& path, const Map& map, const WriteOptions& o, const py::object& progress) {
  run_operation(progress, [=](const Run& run) { write(path, *map, o, run); });
}

py::bytes encode_map(const Map& map, const WriteOptions& o, const py::object& progress) {
  const std::vector<std::byte> bytes = run_operation(progress, [=](const Run& run) { return encode(*map, o, run); });
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

py::list pack_map(const Map& map, const std::string& format, const std::string& orientation, bool clamp,
                  const py::object& progress) {
  static constexpr std::string_view orientations[] = {"graphics-api", "seen-from-inside"};
  const PackOptions o{.format = named<PixelFormat>("format", format, pixel_format_names),
                      .orientation = named<FaceOrientation>("orientation", orientation, orientations),
                      .clamp = clamp};
  const PackedMap packed = run_operation(progress, [=](const Run& run) { return pack(*map, o, run); });
  const py::bytes bytes(reinterpret_cast<const char*>(packed.bytes.data()), packed.bytes.size());
  py::list levels;
  for (int k = 0; k < packed.levels; ++k) {
    levels.append(packed_level(packed, k, bytes));
    levels[std::size_t(k)].attr("setflags")("write"_a = false);
  }
  return levels;
}

// A member of options that Python sets, and never reads.
template <class Options, class Set>
void add_setter(py::class_<Options>& options, const char* name, Set set) {
  options.def_property(name, nullptr, py::cpp_function(set));
}

void add_read_options(py::module_& m) {
  using Word = const std::string&;
  using O = ReadOptions;
  py::class_<O> options(m, "ReadOptions");
  options.def(py::init<>())
      .def_readwrite("faces", &O::faces)
      .def_readwrite("border", &O::border)
      .def_readwrite("border_samples", &O::border_samples)
      .def_readwrite("apply_pose", &O::apply_pose)
      .def_readwrite("max_memory", &O::max_memory)
      .def_readwrite("max_pixels", &O::max_pixels)
      .def_readwrite("drop_channels", &O::drop_channels)
      .def_readwrite("level", &O::level)
      .def_readwrite("all_levels", &O::all_levels);
  add_setter(options, "projection", [](O& o, Word word) { o.projection = projection_of(word); });
  add_setter(options, "layout", [](O& o, Word word) { o.layout = layout_of(word); });
  add_setter(options, "forward", [](O& o, Word word) { o.forward = forward_of(word); });
  add_setter(options, "repair", [](O& o, bool yes) { o.flaws = yes ? FlawPolicy::repair : FlawPolicy::refuse; });
  add_setter(options, "space", [](O& o, Word word) { o.colour.space = word; });
  add_setter(options, "working", [](O& o, Word word) { o.colour.working = word; });
  add_setter(options, "headroom", [](O& o, double stops) { o.choice.headroom = stops; });
  add_setter(options, "layer", [](O& o, Word word) { o.choice.layer = word; });
}

void add_write_options(py::module_& m) {
  using Word = const std::string&;
  using O = WriteOptions;
  py::class_<O> options(m, "WriteOptions");
  options.def(py::init<>())
      .def_readwrite("faces", &O::faces)
      .def_readwrite("format", &O::format)
      .def_readwrite("compression", &O::compression)
      .def_readwrite("clamp", &O::clamp)
      .def_readwrite("zstd", &O::zstd)
      .def_readwrite("facts", &O::facts);
  add_setter(options, "depth", [](O& o, Word word) { o.depth = depth_of(word); });
  add_setter(options, "layout", [](O& o, Word word) { o.layout = layout_of(word); });
  add_setter(options, "force", [](O& o, bool yes) { o.commit.force = yes; });
}

}  // namespace

void add_files(py::module_& m) {
  add_read_options(m);
  add_write_options(m);
  m.def("read_file", &read_file);
  m.def("read_bytes", &read_bytes);
  m.def("write", &write_file);
  m.def("encode", &encode_map);
  m.def("pack", &pack_map);
}

}  // namespace envmap_python
