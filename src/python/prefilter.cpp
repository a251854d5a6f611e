// envmap.prefilter().
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <variant>

#include "words.h"

namespace envmap_python {
namespace {

namespace py = pybind11;
using namespace py::literals;
using namespace envmap;

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
  const double* const one = std::get_if<double>(&*given);
  const std::vector<double> all = one ? std::vector{*one} : std::get<std::vector<double>>(*given);
  if (all.empty()) throw UsageError("a chain has a level or more");
  for (const double value : all) check_range(has_exponent ? limits::exponent : limits::roughness, value);
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

}  // namespace

void add_prefilter(py::module_& m) {
  py::class_<PrefilteredMap>(m, "Prefiltered", "What prefilter() made, and how.")
      .def_readonly("map", &PrefilteredMap::map)
      .def_readonly("method", &PrefilteredMap::method,
                    "exact, treecode, prefix-sums or multilevel: that of most texels; area or nearest of a mirror.")
      .def_readonly("error", &PrefilteredMap::error, "The largest figure of a texel; 0 of exact sums.")
      .def_readonly("exact", &PrefilteredMap::exact, "Texels that were summed exactly.");

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
}

}  // namespace envmap_python
