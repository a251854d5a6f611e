// envmap.Map: maps of arrays, and arrays of maps.
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <algorithm>

#include "words.h"

namespace envmap_python {
namespace {

namespace py = pybind11;
using namespace py::literals;
using namespace envmap;

using Array = py::array_t<float, py::array::forcecast>;

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
  if (const auto n = a.ndim(); (n == 3 || n == 4) && a.shape(n - 1) == 4)
    throw UsageError("an array is (height, width, 3), without alpha: array[..., :3] leaves it out");
  if ((!image && !several) || a.size() == 0)
    throw UsageError("an array is (height, width, 3), of a cube (6, N, N, 3), of a paraboloid map (2, N, N, 3)");
  if (projection) return projection_of(*projection);
  if (several && a.shape(0) == 2)
    throw UsageError("an array (2, N, N, 3) may be a paraboloid map or two images", Remedy::choose_projection);
  if (several) return Projection::cube;
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

std::string type_name(const py::handle& given) { return py::cast<std::string>(py::type::of(given).attr("__name__")); }

// Radiance is floating point. Integers are pixels of pictures, encoded by a curve and of any white.
void check_numbers(const py::array& a) {
  switch (a.dtype().kind()) {
    case 'f': return;
    case 'i':
    case 'u':
      throw UsageError("an array of " + py::cast<std::string>(py::str(a.dtype())) +
                       " is no radiance: decode it to linear floats; .astype('float32') where it is linear");
    default:
      throw UsageError("an array of " + py::cast<std::string>(py::str(a.dtype())) + " is no radiance: floats are");
  }
}

void check_unmasked(const py::object& given) {
  if (py::hasattr(given, "filled") && py::hasattr(given, "mask") && py::cast<bool>(given.attr("mask").attr("any")()))
    throw UsageError("a masked array has values that are none: .filled(0) or another value replaces them");
}

// What numpy makes of an object, or nothing. Of None it would make NaN.
std::optional<py::array> array_from(const py::object& given) {
  if (given.is_none()) return std::nullopt;
  py::array a = py::array::ensure(given);
  if (a && a.dtype().kind() == 'O') a = py::array::ensure(a.attr("tolist")());  // Objects are numbers, or not.
  PyErr_Clear();
  if (!a || a.ndim() == 0 || a.dtype().kind() == 'O') return std::nullopt;
  return a;
}

Array array_of(const py::object& given) {
  const std::optional<py::array> a = array_from(given);
  if (!a)
    throw UsageError("a map is an envmap.Map or an array of numbers, not " + type_name(given) +
                     (py::hasattr(given, "map") ? ": take its .map" : ""));
  check_unmasked(given);
  if (a->size() > 0) check_numbers(*a);
  return Array::ensure(*a);
}

// @param forward None: the map's own.
Map copy_of(const EnvironmentMap& map, const std::optional<std::string>& projection,
            const std::optional<std::string>& forward) {
  if (projection && projection_of(*projection) != map.projection())
    throw UsageError("a Map has its projection: convert() makes one in another");
  EnvironmentMap copy = map.clone();
  if (forward) copy.forward = Frame(map.projection(), forward_of(*forward)).forward;
  return shared(std::move(copy));
}

Map map_of_levels(const py::object& levels, const std::optional<std::string>& projection, const std::string& forward) {
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

// A copy of a map, or a map of one array, or of those of all levels, the largest first.
Map make_map(const py::object& array, const std::optional<std::string>& projection,
             const std::optional<std::string>& forward, const py::object& levels) {
  if (array.is_none() == levels.is_none()) throw UsageError("name an array or levels=, and not both");
  if (py::isinstance<EnvironmentMap>(array)) return copy_of(*py::cast<Map>(array), projection, forward);
  if (levels.is_none()) return map_of_object(array, projection, forward.value_or("+z"));
  Map map = map_of_levels(levels, projection, forward.value_or("+z"));
  check_levels(*map);
  return map;
}

py::tuple state_of(const Map& map) {
  py::list levels;
  for (Level& level : map->levels) levels.append(view(map, level).attr("copy")());
  return py::make_tuple(levels, std::string(name(map->projection())),
                        std::string(forward_names[std::size_t(map->forward)]));
}

// A chain that was read may round up, as its writer did.
Map of_state(const py::tuple& state) {
  return map_of_levels(state[0], state[1].cast<std::string>(), state[2].cast<std::string>());
}

py::list views(const Map& map) {
  py::list all;
  for (Level& level : map->levels) all.append(view(map, level));
  return all;
}

}  // namespace

Map map_of_object(const py::object& array, const std::optional<std::string>& projection, const std::string& forward) {
  return shared(map_of_array(array_of(array), projection, forward));
}

void add_map(py::module_& m) {
  py::class_<EnvironmentMap, Map>(
      m, "Map",
      document("Map", "array=None, projection=None, forward=None, *, levels=None",
               "An environment map: linear RGB radiance, float32, by face and mip level.\n\n"
               "An array is copied: (height, width, 3), of a cube (6, N, N, 3), of a paraboloid map (2, N, N, 3). An "
               "array twice as wide as "
               "high is a latlong map by default; a paraboloid map is named by projection=. Values are floats. Another "
               "Map is copied with its levels and its forward axis, which is '+z' of arrays. levels= takes the arrays "
               "of a whole mip chain, the largest first."))
      .def(py::init(&make_map), "array"_a = py::none(), "projection"_a = py::none(), "forward"_a = py::none(),
           py::kw_only(), "levels"_a = py::none())
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
}

}  // namespace envmap_python
