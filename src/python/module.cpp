// The Python module: the library's public functions on numpy arrays.
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>
#include <tbb/global_control.h>

#include <variant>

#include "words.h"

namespace envmap_python {
namespace {

namespace py = pybind11;
using namespace py::literals;
using namespace envmap;

using Array = py::array_t<float, py::array::forcecast>;

Map shared(EnvironmentMap&& map) { return std::make_shared<EnvironmentMap>(std::move(map)); }
Rgb<double> rgb(const Triple& t) { return {t[0], t[1], t[2]}; }
Triple triple(const Rgb<double>& c) { return {c.x, c.y, c.z}; }

// ---- arrays ---------------------------------------------------------------------------------------------------------

// A view of a level's texels, without a copy: (height, width, 3), of several faces (faces, height, width, 3).
py::array view(const Map& map, Level& level) {
  const auto line = static_cast<py::ssize_t>(level.stride() * std::ptrdiff_t(sizeof(Colour)));
  const Colour* const first = level.texel(0, 0, 0);
  std::vector<py::ssize_t> shape{level.height(), level.width(), 3}, strides{line, sizeof(Colour), sizeof(float)};
  if (level.faces() > 1) {
    shape.insert(shape.begin(), level.faces());
    strides.insert(strides.begin(),
                   reinterpret_cast<const char*>(level.texel(1, 0, 0)) - reinterpret_cast<const char*>(first));
  }
  return py::array_t<float>(shape, strides, &first->x, py::cast(map));
}

Projection projection_of_array(const Array& a, const std::optional<std::string>& projection) {
  const bool image = a.ndim() == 3 && a.shape(2) == 3, several = a.ndim() == 4 && a.shape(3) == 3;
  if ((!image && !several) || a.size() == 0)
    throw UsageError("an array is (height, width, 3), of a cube (6, N, N, 3), of a paraboloid map (2, N, N, 3)");
  if (projection) return projection_of(*projection);
  if (several) return a.shape(0) == 2 ? Projection::paraboloid : Projection::cube;
  if (a.shape(1) == 2 * a.shape(0)) return Projection::latlong;
  throw UsageError("an array that is not twice as wide as high may be of several projections",
                   Remedy::choose_projection);
}

Level level_of_array(const Array& a, Projection p) {
  const bool several = a.ndim() == 4;
  const auto height = int(a.shape(several ? 1 : 0)), width = int(a.shape(several ? 2 : 1));
  if ((several ? a.shape(0) : 1) != faces(p) || (p != Projection::latlong && width != height) || a.size() == 0)
    throw UsageError("the array's shape is not that of a " + std::string(name(p)) + " map");
  Level level(p, height, width);
  for (int face = 0; face < level.faces(); ++face)
    for (int j = 0; j < height; ++j)
      for (int i = 0; i < width; ++i)
        for (int c = 0; c < 3; ++c) (*level.texel(face, i, j))[c] = several ? a.at(face, j, i, c) : a.at(j, i, c);
  if (find_flaws(level).count() > 0) throw InputError("the array holds NaN, infinite or negative radiance");
  return level;
}

EnvironmentMap map_of_array(const Array& a, const std::optional<std::string>& projection, const std::string& forward) {
  const Projection p = projection_of_array(a, projection);
  if (p == Projection::latlong && a.shape(1) != 2 * a.shape(0))
    throw UsageError("a latlong map is twice as wide as high");
  EnvironmentMap map{.levels = {}, .forward = Frame(p, forward_of(forward)).forward};
  map.levels.push_back(level_of_array(a, p));
  return map;
}

Array array_of(const py::object& given) {
  if (!given.is_none())  // numpy makes NaN of it.
    if (Array a = Array::ensure(given)) return a;
  PyErr_Clear();
  throw UsageError("a map is an envmap.Map or an array of numbers, not " +
                   py::cast<std::string>(py::type::of(given).attr("__name__")));
}

// Of one array, or of those of all levels, the largest first.
Map make_map(const py::object& array, const std::optional<std::string>& projection, const std::string& forward,
             const py::object& levels) {
  if (array.is_none() == levels.is_none()) throw UsageError("name an array or levels=, and not both");
  if (levels.is_none()) return map_of_object(array, projection, forward);
  if (!py::isinstance<py::sequence>(levels) || py::len(levels) == 0)
    throw UsageError("levels= is a list of arrays, the largest first");
  EnvironmentMap map;
  for (const py::handle level : levels) {
    const Array a = array_of(py::reinterpret_borrow<py::object>(level));
    if (map.levels.empty())
      map = map_of_array(a, projection, forward);
    else if (a.ndim() == (map.base().faces() > 1 ? 4 : 3) && a.shape(a.ndim() - 1) == 3)
      map.levels.push_back(level_of_array(a, map.projection()));
    else
      throw UsageError("all levels have the shape of the first, but for their size");
  }
  return shared(std::move(map));
}

py::tuple state_of(const Map& map) {
  py::list levels;
  for (Level& level : map->levels) levels.append(view(map, level).attr("copy")());
  return py::make_tuple(levels, std::string(name(map->projection())),
                        std::string(forward_names[std::size_t(map->forward)]));
}

Map of_state(const py::tuple& state) {
  return make_map(py::none(), state[1].cast<std::string>(), state[2].cast<std::string>(), state[0]);
}

py::list views(const Map& map) {
  py::list all;
  for (Level& level : map->levels) all.append(view(map, level));
  return all;
}

// ---- files ----------------------------------------------------------------------------------------------------------

std::filesystem::path path_of(const py::object& file) {
  try {
    return file.cast<std::filesystem::path>();
  } catch (const py::cast_error&) {
    throw UsageError("a file is named by a str or an os.PathLike, not by " +
                     py::cast<std::string>(py::type::of(file).attr("__name__")));
  }
}

Map read_file(const py::object& file, const std::optional<std::string>& projection,
              const std::optional<std::string>& layout, const std::optional<std::string>& forward, int level,
              bool all_levels, bool repair, bool drop_channels, const std::string& space, const std::string& working) {
  ReadOptions o;
  if (projection) o.projection = projection_of(*projection);
  if (layout) o.layout = layout_of(*layout);
  if (forward) o.forward = forward_of(*forward);
  o.level = level, o.all_levels = all_levels, o.drop_channels = drop_channels;
  o.flaws = repair ? FlawPolicy::repair : FlawPolicy::refuse;
  o.colour.space = space, o.colour.working = working;
  if (PyObject_CheckBuffer(file.ptr())) {
    const py::buffer_info bytes = py::reinterpret_borrow<py::buffer>(file).request();
    if (bytes.ndim != 1 || bytes.itemsize != 1 || bytes.strides[0] != 1) throw UsageError("a file in memory is bytes");
    const py::gil_scoped_release others;
    return shared(std::move(read({static_cast<const std::byte*>(bytes.ptr), std::size_t(bytes.size)}, o).map));
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
                const std::optional<std::string>& layout, const std::string& format, const std::string& compression,
                bool clamp, bool zstd, const Facts& facts, bool force, const py::object& progress) {
  WriteOptions o = write_options(depth, layout, format, compression, clamp, zstd, facts);
  o.commit.force = force;
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

// ---- operations -----------------------------------------------------------------------------------------------------

Map convert_map(const GivenMap& given, const std::optional<std::string>& to, std::optional<int> size,
                const std::optional<std::string>& filter, int samples, std::optional<double> max_error,
                const Triple& rotate, const std::string& mirror, double gain, const std::optional<std::string>& forward,
                std::optional<double> ball_distance, std::optional<double> ball_fov, const py::object& progress) {
  const Map& map = given.map;
  const Frame from = map->frame();
  ConvertOptions o{.to = {to ? projection_of(*to) : from.projection, forward ? forward_of(*forward)
                                                                     : to    ? Forward::plus_z
                                                                             : from.forward},
                   .size = size,
                   .samples = samples,
                   .max_error = max_error,
                   .rotation = rotation(rotate[0], rotate[1], rotate[2]),
                   .mirror = named<MirroredAxis>("mirror", mirror, mirrored_axis_names),
                   .gain = gain};
  if (filter) o.filter = filter_of(*filter);
  if (ball_distance && ball_fov) throw UsageError("say ball_distance= or ball_fov=, not both");
  if (ball_distance) o.ball = BallCamera{*ball_distance};
  if (ball_fov) o.ball = BallCamera::of_field_of_view(*ball_fov);
  return shared(Reporter(progress).run([&](const Run& r) { return convert(*map, o, r); }));
}

Map mipmap(const GivenMap& given, int levels, const std::string& weights) {
  const Map& map = given.map;
  const Weights w = weights_of(weights);
  const py::gil_scoped_release others;
  EnvironmentMap all{.levels = {}, .forward = map->forward};
  all.levels.push_back(map->base().clone());
  add_levels(all.levels, w, levels);
  return shared(std::move(all));
}

struct PrefilteredMap {
  Map map = {};
  std::string method = {};
  double error = 0;
  std::int64_t exact = 0;
};

// A number, or one for each level of a chain.
using Parameter = std::optional<std::variant<double, std::vector<double>>>;

std::vector<double> parameters(Shape shape, const std::string& lobe, const Parameter& exponent,
                               const Parameter& roughness) {
  const bool has_exponent = shape == Shape::phong || shape == Shape::blinn_phong;
  const Parameter& given = has_exponent ? exponent : roughness;
  if (shape != Shape::diffuse && !given)
    throw UsageError(lobe + (has_exponent ? ": say exponent=" : ": say roughness="));
  if ((exponent && !has_exponent) || (roughness && (has_exponent || shape == Shape::diffuse)))
    throw UsageError(lobe + (exponent ? " has no exponent" : " has no roughness"));
  if (!given) return {unset_parameter};
  if (const double* one = std::get_if<double>(&*given)) return {*one};
  const auto& all = std::get<std::vector<double>>(*given);
  if (all.empty()) throw UsageError("a chain has a level or more");
  return all;
}

PrefilteredMap prefilter_map(const GivenMap& given, const std::string& lobe, const Parameter& exponent,
                             const Parameter& roughness, const std::string& to, std::optional<int> size,
                             const std::string& method, double max_error, std::optional<double> scale,
                             const std::string& forward, const py::object& progress) {
  const Map& map = given.map;
  Prefilter wanted{.shape = shape_of(lobe),
                   .scale = scale,
                   .to = projection_of(to),
                   .forward = forward_of(forward),
                   .method = method_of(method),
                   .max_error = max_error};
  const std::vector<double> levels = parameters(wanted.shape, lobe, exponent, roughness);
  wanted.size =
      size.value_or(wanted.shape == Shape::diffuse ? matching_size(Projection::cube, 64, wanted.to)
                                                   : matching_size(map->projection(), map->base().height(), wanted.to));
  return Reporter(progress).run([&](const Run& r) {
    const PrefilterSource source(*map);
    PrefilteredMap made;
    PrefilteredChain chain = source.make_chain(wanted, levels, r);
    made.method = std::string(method_name(chain.levels.front()));
    for (const Prefiltered& level : chain.levels) {
      made.error = std::max(made.error, level.error);
      made.exact += level.exact;
    }
    made.map = shared(std::move(chain.map));
    return made;
  });
}

// As `envmap sh --window`: what is left of each degree, so that bright lights ring less.
enum class Window { none, hann, automatic };
constexpr std::string_view window_words[] = {"none", "hann", "auto"};
void apply(Window window, Harmonics& h) {
  if (window == Window::hann) scale_degrees(h, hann_window(h.order));
  if (window == Window::automatic) scale_degrees(h, laplacian_window(h.order, weakest_window(h).lambda));
}

py::array_t<double> sh(const GivenMap& given, int order, bool irradiance, const std::string& window,
                       const py::object& progress) {
  const auto kind = named<Window>("window", window, window_words);
  Harmonics h = Reporter(progress).run([&](const Run& r) {
    Harmonics found = project(*given.map, order, r);
    apply(kind, found);
    return found;
  });
  if (irradiance) scale_degrees(h, irradiance_factors(order));
  py::array_t<double> out({static_cast<py::ssize_t>(h.coefficients.size()), py::ssize_t{3}});
  for (std::size_t k = 0; k < h.coefficients.size(); ++k)
    for (int c = 0; c < 3; ++c) out.mutable_at(static_cast<py::ssize_t>(k), c) = h.coefficients[k][c];
  return out;
}

Difference compare_maps(const GivenMap& a, const GivenMap& b) {
  const py::gil_scoped_release others;
  return compare(*a.map, *b.map);
}

py::array_t<float> table_of(const std::string& lobe, int size, const py::object& progress) {
  const Shape shape = shape_of(lobe);
  if (shape != Shape::ggx && shape != Shape::charlie) throw UsageError("a table is of the lobe ggx or charlie");
  const std::vector<Colour> table = Reporter(progress).run(
      [&](const Run& r) { return shape == Shape::ggx ? brdf_table(size, r) : sheen_table(size, r); });
  return py::array_t<float>({py::ssize_t{size}, py::ssize_t{size}, py::ssize_t{3}}, &table.front().x);
}

py::array_t<double> solid_angles_of(const std::string& projection, int size) {
  const Projection p = projection_of(projection);
  check(limits::size, size);
  const py::ssize_t width = py::ssize_t{size} * aspect(p);
  py::array_t<double> out({py::ssize_t{size}, width});
  for (int j = 0; j < size; ++j) solid_angles(p, size, j, {out.mutable_data(j, 0), std::size_t(width)});
  return out;
}

// A parameter of a pattern, taken out of what was given.
template <class T>
T take(py::kwargs& given, const char* name, const T& otherwise) {
  if (!given.contains(name)) return otherwise;
  const T value = py::cast<T>(given[name]);
  given.attr("pop")(name);
  return value;
}

// A number is all three channels.
Rgb<double> take(py::kwargs& given, const char* name, const Rgb<double>& otherwise) {
  if (given.contains(name) && (py::isinstance<py::float_>(given[name]) || py::isinstance<py::int_>(given[name])))
    return Rgb<double>(take(given, name, 0.0));
  return rgb(take(given, name, triple(otherwise)));
}

Sky sky_of(py::kwargs& k) {
  Sky sky{take(k, "zenith", Rgb<double>(1)), take(k, "ground", Rgb<double>(0.2))};
  if (k.contains("horizon")) sky.horizon = take(k, "horizon", Rgb<double>(0));
  return sky;
}

Pattern pattern(const std::string& kind, py::kwargs& k) {
  if (kind == "constant") return Constant{take(k, "radiance", Rgb<double>(1))};
  if (kind == "gradient") return Gradient{take(k, "bottom", Rgb<double>(0.1)), take(k, "top", Rgb<double>(1))};
  if (kind == "checker")
    return Checker{take(k, "squares", 8), take(k, "even", Rgb<double>(1)), take(k, "odd", Rgb<double>(0.1))};
  if (kind == "directions") return Directions{};
  if (kind == "faces") return Faces{};
  if (kind == "sky") return sky_of(k);
  if (kind == "sh")
    return Harmonic{take(k, "degree", 2), take(k, "order", 0), take(k, "base", 1.0), take(k, "amplitude", 0.5)};
  if (kind != "sun")
    throw UsageError("kind '" + kind + "' is none of constant, gradient, checker, directions, faces, sun, sky, sh");
  const Triple to = take(k, "direction", Triple{0, 0, 1});
  const Direction d(to[0], to[1], to[2]);
  if (!(glm::length(d) > 0)) throw UsageError("a direction has a length");
  return Sun{glm::normalize(d), take(k, "radius", 0.2666), take(k, "radiance", Rgb<double>(1e5)), sky_of(k)};
}

Map generate_map(const std::string& kind, const std::string& to, int size, const std::string& forward,
                 py::kwargs parameters) {
  const Pattern wanted = pattern(kind, parameters);
  if (parameters.size() > 0)
    throw UsageError(kind + " has no parameter " + py::cast<std::string>(parameters.begin()->first));
  const Frame frame(projection_of(to), forward_of(forward));
  const py::gil_scoped_release others;
  return shared(generate(wanted, frame, size));
}

void limit_threads(int count) {
  static std::optional<tbb::global_control> limit;
  check(limits::threads, count);
  limit.reset();
  if (count > 0) limit.emplace(tbb::global_control::max_allowed_parallelism, std::size_t(count));
}

}  // namespace

Map map_of_object(const py::object& array, const std::optional<std::string>& projection, const std::string& forward) {
  return shared(map_of_array(array_of(array), projection, forward));
}

PYBIND11_MODULE(_envmap, m) {
  add_errors(m);
  m.attr("__version__") = ENVMAP_VERSION;
  py::options options;
  options.disable_function_signatures();  // document() has those that Python can read.
  py::class_<EnvironmentMap, Map>(
      m, "Map",
      document("Map", "array=None, projection=None, forward='+z', *, levels=None",
               "An environment map: linear RGB radiance, float32, by face and mip level.\n\n"
               "An array is copied: (height, width, 3), of a cube (6, N, N, 3), of a paraboloid map (2, N, N, 3). An "
               "array twice as wide as "
               "high is a latlong map by default. levels= takes the arrays of a whole mip chain, the largest first."))
      .def(py::init(&make_map), "array"_a = py::none(), "projection"_a = py::none(), "forward"_a = "+z", py::kw_only(),
           "levels"_a = py::none())
      .def(py::pickle(&state_of, &of_state))
      .def_property_readonly(
          "array", [](const Map& map) { return view(map, map->base()); },
          "Level 0, a view without a copy: (height, width, 3), of several faces (faces, height, width, 3). "
          "Cube faces are +X -X +Y -Y +Z -Z.")
      .def_property_readonly("levels", &views, "Views of all levels, the largest first.")
      .def_property_readonly("projection", [](const EnvironmentMap& map) { return name(map.projection()); })
      .def_property_readonly(
          "forward", [](const EnvironmentMap& map) { return forward_names[std::size_t(map.forward)]; },
          "World axis at the centre of latlong and angular images.")
      .def_property_readonly(
          "size", [](const EnvironmentMap& map) { return map.base().height(); }, "Height of a face in texels.")
      .def("__array__",
           [](const Map& map, const py::args& how, const py::kwargs& more) {
             return py::object(view(map, map->base())).attr("__array__")(*how, **more);
           })
      .def("__repr__", [](const EnvironmentMap& map) {
        return "<envmap.Map " + std::string(name(map.projection())) + " " + std::to_string(map.base().width()) + "x" +
               std::to_string(map.base().height()) +
               (map.base().faces() > 1 ? " x " + std::to_string(map.base().faces()) : "") + ">";
      });
  py::class_<PrefilteredMap>(m, "Prefiltered", "What prefilter() made, and how.")
      .def_readonly("map", &PrefilteredMap::map)
      .def_readonly("method", &PrefilteredMap::method,
                    "exact, hierarchical, prefix-sums or multilevel: that of most texels; area or nearest of a mirror.")
      .def_readonly("error", &PrefilteredMap::error, "The largest figure of a texel; 0 of exact sums.")
      .def_readonly("exact", &PrefilteredMap::exact, "Texels that were summed exactly.");
  py::class_<Difference>(m, "Difference", "Of a map against a reference; solid-angle weighted.")
      .def_property_readonly(
          "flux", [](const Difference& d) { return triple(d.flux); }, "(flux a - flux b) / flux b by channel.")
      .def_readonly("rms", &Difference::rms, "sqrt(sum w |a-b|^2 / sum w |b|^2).")
      .def_readonly("max", &Difference::maximum, "Largest |a-b| / max(|b|, 0.001 x mean of b).");

  m.def("read", &read_file, "file"_a, py::kw_only(), "projection"_a = py::none(), "layout"_a = py::none(),
        "forward"_a = py::none(), "level"_a = 0, "all_levels"_a = false, "repair"_a = false, "drop_channels"_a = false,
        "space"_a = "", "working"_a = "",
        document("read",
                 "file, *, projection=None, layout=None, forward=None, level=0, all_levels=False, repair=False, "
                 "drop_channels=False, space='', working=''",
                 "Reads a map of a file, or of a file's bytes. {face} in the name reads six files."));
  m.def("write", &write_file, "file"_a, "map"_a, py::kw_only(), "depth"_a = py::none(), "layout"_a = py::none(),
        "format"_a = "", "compression"_a = "", "clamp"_a = false, "zstd"_a = false, "facts"_a = Facts{},
        "force"_a = false, "progress"_a = py::none(),
        document("write",
                 "file, map, *, depth=None, layout=None, format='', compression='', clamp=False, zstd=False, facts={}, "
                 "force=False, progress=None",
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
  m.def("convert", &convert_map, "map"_a, "to"_a = py::none(), py::kw_only(), "size"_a = py::none(),
        "filter"_a = py::none(), "samples"_a = 1, "max_error"_a = py::none(), "rotate"_a = Triple{0, 0, 0},
        "mirror"_a = "none", "gain"_a = 1.0, "forward"_a = py::none(), "ball_distance"_a = py::none(),
        "ball_fov"_a = py::none(), "progress"_a = py::none(),
        document("convert",
                 "map, to=None, *, size=None, filter=None, samples=1, max_error=None, rotate=(0, 0, 0), mirror='none', "
                 "gain=1.0, "
                 "forward=None, "
                 "ball_distance=None, ball_fov=None, progress=None",
                 "A map in another projection, size or frame. ball_distance (from its centre, in radii of the ball) or "
                 "ball_fov (degrees "
                 "from one side of it to the other): the map is the photo of a mirror ball by a camera so near; what "
                 "lies hidden behind "
                 "the ball gets the colours of its rim."));
  m.def(
      "mipmap", &mipmap, "map"_a, py::kw_only(), "levels"_a = 0, "weights"_a = "solid-angle",
      document(
          "mipmap", "map, *, levels=0, weights='solid-angle'",
          "The map with its mip levels, each the solid-angle weighted means of the one before; 0: down to one texel."));
  m.def("prefilter", &prefilter_map, "map"_a, "lobe"_a = "diffuse", py::kw_only(), "exponent"_a = py::none(),
        "roughness"_a = py::none(), "to"_a = "cube", "size"_a = py::none(), "method"_a = "auto", "max_error"_a = 1e-3,
        "scale"_a = py::none(), "forward"_a = "+z", "progress"_a = py::none(),
        document("prefilter",
                 "map, lobe='diffuse', *, exponent=None, roughness=None, to='cube', size=None, method='auto', "
                 "max_error=0.001, scale=None, "
                 "forward='+z', progress=None",
                 "The map that a material of that lobe reflects, every texel within max_error. A list of roughnesses "
                 "or exponents makes a "
                 "mip chain: a level for each, half the size of the one before."));
  m.def(
      "sh", &sh, "map"_a, "order"_a = 2, py::kw_only(), "irradiance"_a = false, "window"_a = "none",
      "progress"_a = py::none(),
      document("sh", "map, order=2, *, irradiance=False, window='none', progress=None",
               "Coefficients of real spherical harmonics, an array ((order + 1)^2, 3), at l (l + 1) + m. window='auto' "
               "is the weakest that keeps irradiance above 0; 'hann' is the other."));
  m.def("compare", &compare_maps, "a"_a, "b"_a,
        document("compare", "a, b", "Level 0 of map a against that of the reference b."));
  m.def("generate", &generate_map, "kind"_a, "to"_a = "latlong", "size"_a = 64, "forward"_a = "+z",
        document("generate", "kind, to='latlong', size=64, forward='+z', **parameters",
                 "An environment with a known answer: constant, gradient, checker, directions, faces, sun, sky or sh, "
                 "with its parameters."));
  m.def("limit_threads", &limit_threads, "count"_a,
        document("limit_threads", "count", "Lets all calls together use at most so many threads; 0: all cores again."));
  add_bake(m);
  add_render(m);
  m.def("brdf_table", &table_of, "lobe"_a = "ggx", "size"_a = 128, py::kw_only(), "progress"_a = py::none(),
        document(
            "brdf_table", "lobe='ggx', size=128, *, progress=None",
            "The other factor of the split sum, an array (size, size, 3): roughness by row, the smoothest first, and "
            "the cosine of the view by column; red scale, green bias. Of charlie the albedo of sheen."));
  m.def("solid_angles", &solid_angles_of, "projection"_a, "size"_a,
        document("solid_angles", "projection, size", "Steradians of each texel of a face, an array (height, width)."));
}

}  // namespace envmap_python
