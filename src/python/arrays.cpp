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

// A chain that was read may round up, as its writer did.
bool halves(int finer, int coarser) { return coarser == std::max(1, finer / 2) || coarser == (finer + 1) / 2; }

void check_halved(const Level& finer, const Level& coarser) {
  if (halves(finer.width(), coarser.width()) && halves(finer.height(), coarser.height())) return;
  const auto size = [](const Level& l) { return std::to_string(l.width()) + "x" + std::to_string(l.height()); };
  throw UsageError("a level of " + size(coarser) + " follows one of " + size(finer) + ": each level is half as large");
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
    if (map.levels.size() > 1) check_halved(map.levels.end()[-2], map.levels.back());
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

}  // namespace

Map map_of_object(const py::object& array, const std::optional<std::string>& projection, const std::string& forward) {
  return shared(map_of_array(array_of(array), projection, forward));
}

void add_map(py::module_& m) {
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
}

}  // namespace envmap_python
