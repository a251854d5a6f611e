// Operations on maps: convert, mip levels, harmonics, tables, differences.
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include "words.h"

namespace envmap_python {
namespace {

namespace py = pybind11;
using namespace py::literals;
using namespace envmap;

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

MapDifference compare_maps(const GivenMap& a, const GivenMap& b) {
  const py::gil_scoped_release others;
  return compare(*a.map, *b.map);
}

// As a map of one level has it.
MapDifference one_level(const Difference& d, int level) {
  MapDifference all{};
  static_cast<Difference&>(all) = d;
  all.worst_level = level;
  return all;
}

py::list levels_of(const MapDifference& d) {
  py::list all;
  for (std::size_t k = 0; k < d.levels.size(); ++k) all.append(one_level(d.levels[k], int(k)));
  return all;
}

std::string shown(const MapDifference& d) {
  const auto number = [](double x) { return py::cast<std::string>(py::str("{:.3g}").format(x)); };
  std::string line = "<envmap.Difference flux " + number(d.flux.x) + " " + number(d.flux.y) + " " + number(d.flux.z) +
                     ", rms " + number(d.rms) + ", max " + number(d.maximum);
  line += " at face " + std::to_string(d.worst.face) + ", row " + std::to_string(d.worst.j) + ", column " +
          std::to_string(d.worst.i);
  if (d.levels.size() > 1) line += " of level " + std::to_string(d.worst_level);
  return line + ">";
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
  check_range(limits::size, size);
  const py::ssize_t width = py::ssize_t{size} * aspect(p);
  py::array_t<double> out({py::ssize_t{size}, width});
  for (int j = 0; j < size; ++j) solid_angles(p, size, j, {out.mutable_data(j, 0), std::size_t(width)});
  return out;
}

}  // namespace

void add_operations(py::module_& m) {
  py::class_<MapDifference>(m, "Difference",
                            "Of a map against a reference; solid-angle weighted. Of several levels the largest "
                            "figures: a limit that they keep is kept by every level.")
      .def_property_readonly(
          "flux", [](const MapDifference& d) { return triple(d.flux); }, "(flux a - flux b) / flux b by channel.")
      .def_property_readonly(
          "rms", [](const MapDifference& d) { return d.rms; }, "sqrt(sum w |a-b|^2 / sum w |b|^2).")
      .def_property_readonly(
          "max", [](const MapDifference& d) { return d.maximum; }, "Largest |a-b| / max(|b|, 0.001 x mean of b).")
      .def_property_readonly(
          "worst", [](const MapDifference& d) { return py::make_tuple(d.worst.face, d.worst.j, d.worst.i); },
          "Face, row and column of the texel of max.")
      .def_readonly("worst_level", &MapDifference::worst_level, "The level of this texel.")
      .def_property_readonly("levels", &levels_of, "A Difference for each level, the largest level first.")
      .def("__repr__", &shown);

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
  m.def(
      "sh", &sh, "map"_a, "order"_a = 2, py::kw_only(), "irradiance"_a = false, "window"_a = "none",
      "progress"_a = py::none(),
      document("sh", "map, order=2, *, irradiance=False, window='none', progress=None",
               "Coefficients of real spherical harmonics, an array ((order + 1)^2, 3), at l (l + 1) + m. window='auto' "
               "is the weakest that keeps irradiance above 0; 'hann' is the other."));
  m.def("compare", &compare_maps, "a"_a, "b"_a,
        document("compare", "a, b",
                 "Map a against the reference b, level by level. Both have the same size, axis and number of levels."));
  m.def("brdf_table", &table_of, "lobe"_a = "ggx", "size"_a = 128, py::kw_only(), "progress"_a = py::none(),
        document(
            "brdf_table", "lobe='ggx', size=128, *, progress=None",
            "The other factor of the split sum, an array (size, size, 3): roughness by row, the smoothest first, and "
            "the cosine of the view by column; red scale, green bias. Of charlie the albedo of sheen."));
  m.def("solid_angles", &solid_angles_of, "projection"_a, "size"_a,
        document("solid_angles", "projection, size", "Steradians of each texel of a face, an array (height, width)."));
}

}  // namespace envmap_python
