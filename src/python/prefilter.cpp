// envmap.prefilter().
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <variant>

#include "words.h"

namespace envmap_python {
namespace {

namespace py = pybind11;
using namespace envmap;

// Exponents or roughnesses, one for each level.
using Parameters = std::optional<std::vector<double>>;

std::vector<double> parameters(LobeShape shape, const std::string& lobe, const Parameters& exponents,
                               const Parameters& roughnesses) {
  const bool has_exponent = shape == LobeShape::phong || shape == LobeShape::blinn_phong;
  const Parameters& given = has_exponent ? exponents : roughnesses;
  if (shape != LobeShape::diffuse && !given)
    throw UsageError(lobe + (has_exponent ? ": say exponent=" : ": say roughness="));
  if ((exponents && !has_exponent) || (roughnesses && (has_exponent || shape == LobeShape::diffuse)))
    throw UsageError(lobe + (exponents ? " has no exponent" : " has no roughness"));
  if (!given) return {unset_parameter};
  if (given->empty()) throw UsageError("a chain has a level or more");
  for (const double value : *given) check_range(has_exponent ? limits::exponent : limits::roughness, value);
  return *given;
}

// Of a file, or cosines and values.
using Table = std::variant<std::monostate, std::string, std::vector<std::array<double, 2>>>;

Lobe lobe_of(const Table& table) {
  if (const auto* path = std::get_if<std::string>(&table)) return read_lobe(*path);
  std::vector<LobeSample> samples;
  for (const auto& [cosine, value] : std::get<2>(table)) samples.push_back({cosine, value});
  return Lobe::table(std::move(samples));
}

// @return map, method, error, and how many texels were summed exactly.
py::tuple prefilter_map(const Map& map, const std::string& lobe, const Parameters& exponents,
                        const Parameters& roughnesses, const Table& table, const std::string& to,
                        std::optional<int> size, const std::string& method, double max_error,
                        std::optional<double> scale, const std::string& forward, const py::object& progress) {
  PrefilterOptions wanted{.scale = scale,
                          .to = projection_of(to),
                          .forward = forward_of(forward),
                          .method = method_of(method),
                          .max_error = max_error};
  const bool is_table = table.index() > 0;
  if (is_table && (exponents || roughnesses)) throw UsageError("table has neither exponent nor roughness");
  const LobeShape shape = is_table ? LobeShape::table : shape_of(lobe);
  const std::vector<Lobe> lobes =
      is_table ? std::vector{lobe_of(table)} : lobes_of(shape, parameters(shape, lobe, exponents, roughnesses));
  wanted.size =
      size.value_or(shape == LobeShape::diffuse ? matching_size(Projection::cube, 64, wanted.to)
                                                : matching_size(map->projection(), map->base().height(), wanted.to));
  PrefilteredChain chain =
      run_operation(progress, [=](const Run& run) { return Prefilterer(map).make_chain(lobes, wanted, run); });
  double error = 0;
  std::int64_t exact = 0;
  for (const Prefiltered& level : chain.levels) {
    error = std::max(error, level.error);
    exact += level.exact;
  }
  return py::make_tuple(shared(std::move(chain.map)), std::string(method_name(chain.levels.front())), error, exact);
}

}  // namespace

void add_prefilter(py::module_& m) { m.def("prefilter", &prefilter_map); }

}  // namespace envmap_python
