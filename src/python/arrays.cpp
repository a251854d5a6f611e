// The Map of the compiled module: maps of arrays, and arrays of maps.
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <atomic>
#include <bit>
#include <cstring>

#include "words.h"

namespace envmap_python {
namespace {

namespace py = pybind11;
using namespace envmap;

using Array = py::array_t<float>;

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

py::list views(const Map& map) {
  py::list all;
  for (Level& level : map->levels) all.append(view(map, level));
  return all;
}

// Whether a value is NaN, infinite or negative: by its bits, for many at once. Of -0 the answer may be yes.
std::uint32_t doubtful(float x) {
  const auto bits = std::bit_cast<std::uint32_t>(x);
  return (bits | (bits + 0x00800000U)) & 0x80000000U;
}

// An array of floats in native order, with any strides. It must outlive the task.
struct Pixels {
  const char* first;
  py::ssize_t face, row, column, channel;
};

Pixels pixels_of(const Array& a) {
  const auto n = a.ndim();
  return {reinterpret_cast<const char*>(a.data()), n == 4 ? a.strides(0) : 0, a.strides(n - 3), a.strides(n - 2),
          a.strides(n - 1)};
}

// @return whether a value may be a flaw.
bool copy_row(const Pixels& from, int face, int j, std::span<Colour> to) {
  const char* const row = from.first + face * from.face + j * from.row;
  if (from.column == sizeof(Colour) && from.channel == sizeof(float)) {
    std::memcpy(static_cast<void*>(to.data()), row, to.size_bytes());
  } else {
    for (std::size_t i = 0; i < to.size(); ++i)
      for (int c = 0; c < 3; ++c)
        std::memcpy(&to[i][c], row + py::ssize_t(i) * from.column + c * from.channel, sizeof(float));
  }
  std::uint32_t doubt = 0;
  for (const Colour& c : to) doubt |= doubtful(c.x) | doubtful(c.y) | doubtful(c.z);
  return doubt != 0;
}

// @param a (height, width, 3), of several faces (faces, height, width, 3). @param doubt set where a flaw may be.
Level level_of_array(Projection p, const Array& a, std::atomic<bool>& doubt) {
  const auto n = a.ndim();
  Level level(p, int(a.shape(n - 3)), int(a.shape(n - 2)));
  const Pixels from = pixels_of(a);
  const py::gil_scoped_release others;
  in_parallel(std::size_t(level.faces()) * std::size_t(level.height()), [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) {
      const int face = int(k) / level.height(), j = int(k) % level.height();
      if (copy_row(from, face, j, level.row(face, j))) doubt = true;
    }
  });
  return level;
}

// Of the first level that has flaws: its number, counts of NaN, infinite and negative texels, the first of them.
py::object flaws_of(const EnvironmentMap& map) {
  for (std::size_t k = 0; k < map.levels.size(); ++k) {
    const Flaws f = find_flaws(map.levels[k]);
    if (f.count() > 0) return py::make_tuple(k, f.nan, f.infinite, f.negative, index_of(*f.first));
  }
  return py::none();
}

// @return the map, and whether a value may be a flaw.
py::tuple map_of_arrays(const std::string& projection, const std::string& forward, const std::vector<Array>& levels) {
  const Projection p = projection_of(projection);
  EnvironmentMap map{.levels = {}, .forward = Frame(p, forward_of(forward)).forward};
  std::atomic<bool> doubt{false};
  for (const Array& level : levels) map.levels.push_back(level_of_array(p, level, doubt));
  return py::make_tuple(shared(std::move(map)), doubt.load());
}

Map copy_of(const EnvironmentMap& map, const std::optional<std::string>& forward) {
  EnvironmentMap copy = map.clone();
  if (forward) copy.forward = Frame(map.projection(), forward_of(*forward)).forward;
  return shared(std::move(copy));
}

}  // namespace

void add_map(py::module_& m) {
  py::class_<EnvironmentMap, Map>(m, "Map")
      .def("levels", &views)
      .def("projection", [](const EnvironmentMap& map) { return name(map.projection()); })
      .def("forward", [](const EnvironmentMap& map) { return forward_names[std::size_t(map.forward)]; })
      .def("copy", &copy_of)
      .def("check_levels", [](const EnvironmentMap& map) { check_levels(map); })
      .def("flaws", &flaws_of);
  m.def("map_of_arrays", &map_of_arrays);
}

}  // namespace envmap_python
