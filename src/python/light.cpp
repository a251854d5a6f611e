// Light of maps: harmonics, irradiance, lookups, tables of the split sum.
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include "words.h"

namespace envmap_python {
namespace {

namespace py = pybind11;
using namespace envmap;

// (n, 3), as Python prepares them; results have the same shape.
using Directions = py::array_t<double, py::array::c_style>;
using FloatDirections = py::array_t<float, py::array::c_style>;
using Values = py::array_t<double, py::array::c_style>;

py::array_t<double> rows_of(std::span<const Flux> values) {
  static_assert(sizeof(Flux) == 3 * sizeof(double));
  return py::array_t<double>({py::ssize_t(values.size()), py::ssize_t{3}}, values.empty() ? nullptr : &values[0].x);
}

py::array_t<double> sh(const Map& map, int order, bool irradiance, const std::string& window,
                       const py::object& progress) {
  const auto kind = named<ShWindow>("window", window, sh_window_names);
  const Harmonics h = run_operation(progress, [=](const Run& run) {
    Harmonics found = project(*map, order, run);
    apply_window(found, kind, {.stop = run.stop});
    if (irradiance) scale_degrees(found, irradiance_factors(order));
    return found;
  });
  return rows_of(h.coefficients);
}

py::array_t<double> nine_colours(const Map& map, const std::string& basis, const std::string& window,
                                 const py::object& progress) {
  const auto wanted = named<ShBasis>("basis", basis, sh_basis_names);
  const auto kind = named<ShWindow>("window", window, sh_window_names);
  return rows_of(run_operation(progress, [=](const Run& run) { return shader_sh(*map, wanted, kind, run); }));
}

py::array_t<float> table_of(const std::string& lobe, int size, const py::object& progress) {
  const LobeShape shape = shape_of(lobe);
  if (shape != LobeShape::ggx && shape != LobeShape::charlie) throw UsageError("a table is of the lobe ggx or charlie");
  const std::vector<Colour> table = run_operation(progress, [=](const Run& run) {
    return shape == LobeShape::ggx ? brdf_table(size, run) : sheen_table(size, run);
  });
  return py::array_t<float>({py::ssize_t{size}, py::ssize_t{size}, py::ssize_t{3}}, &table.front().x);
}

template <class T>
std::vector<Direction> directions_in(const py::array_t<T, py::array::c_style>& array) {
  const T* const d = array.data();
  std::vector<Direction> all(std::size_t(array.shape(0)));
  for (std::size_t k = 0; k < all.size(); ++k) all[k] = {d[3 * k], d[3 * k + 1], d[3 * k + 2]};
  return all;
}

py::array_t<double> irradiance_at(const Map& map, const Directions& normals) {
  const auto all = std::make_shared<std::vector<Direction>>(directions_in(normals));
  return rows_of(run_operation([=](const Run& run) {
    std::vector<Flux> light;
    for (const Direction& normal : *all) {
      if (run.stop.stop_requested()) throw Cancelled();
      light.push_back(irradiance(*map, normal));
    }
    return light;
  }));
}

// @param levels one for all, or one each.
template <class T>
void look_up(const EnvironmentLookup& look, const T* directions, std::span<const double> levels,
             std::span<Colour> out) {
  in_parallel(out.size(), [&](std::size_t begin, std::size_t end) {
    constexpr std::size_t most = 512;
    std::array<Direction, most> some;
    for (std::size_t k = begin; k < end; k += most) {
      const std::size_t count = std::min(most, end - k);
      for (std::size_t i = 0; i < count; ++i) {
        const T* const d = directions + 3 * (k + i);
        some[i] = {d[0], d[1], d[2]};
      }
      if (levels.size() == 1)
        look(std::span(some).first(count), out.subspan(k, count), levels[0]);
      else
        for (std::size_t i = 0; i < count; ++i) out[k + i] = look(some[i], levels[k + i]);
    }
  });
}

template <class T>
void lookup(const EnvironmentLookup& look, const py::array_t<T, py::array::c_style>& directions, const Values& levels,
            py::array_t<float, py::array::c_style> out) {
  const std::span<Colour> values(reinterpret_cast<Colour*>(out.mutable_data()), std::size_t(directions.shape(0)));
  const std::span<const double> level(levels.data(), std::size_t(levels.size()));
  const T* const first = directions.data();
  const py::gil_scoped_release others;
  look_up(look, first, level, values);
}

EnvironmentLookup lookup_of(const Map& map) {
  return run_operation([=] { return EnvironmentLookup(*map); });
}

struct LightsOf {
  FoundLights found;
  Map remainder;
  LightError error;
};

// @return what the dataclass Light takes, for each light; the remainder; and two errors.
py::tuple lights_of(const Map& map, double min_share, double max_radius, double contrast, int most, double roughness,
                    const py::object& progress) {
  const LightOptions options{min_share, max_radius, contrast, most};
  const LightsOf all = run_operation(progress, [=](const Run& run) {
    LightsOf made{find_lights(*map, options, run), {}, {}};
    made.error = light_error(*map, made.found, roughness);
    EnvironmentMap rest{.levels = {}, .forward = map->forward};
    rest.levels.push_back(map->base().clone());
    take_out(rest, made.found);
    made.remainder = shared(std::move(rest));
    return made;
  });
  py::list lights;
  for (const DiscLight& l : all.found.lights)
    lights.append(py::make_tuple(py::make_tuple(l.towards.x, l.towards.y, l.towards.z), l.within_degrees,
                                 l.radius_degrees, l.radius_is_bound, tuple(l.irradiance), tuple(l.flux),
                                 tuple(l.radiance), l.share));
  return py::make_tuple(lights, all.remainder, all.error.irradiance, all.error.ggx);
}

}  // namespace

void add_light(py::module_& m) {
  py::class_<EnvironmentLookup>(m, "Lookup")
      .def(py::init(&lookup_of))
      .def("floats", &lookup<float>)
      .def("doubles", &lookup<double>);
  m.def("sh", &sh);
  m.def("shader_sh", &nine_colours);
  m.def("brdf_table", &table_of);
  m.def("irradiance", &irradiance_at);
  m.def("lights", &lights_of);
}

}  // namespace envmap_python
