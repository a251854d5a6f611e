// envmap.render(): render_map.h in Python's words.
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <variant>

#include "envmap/scenes.h"
#include "words.h"

namespace envmap_python {
namespace {

namespace py = pybind11;
using namespace py::literals;
using namespace envmap;

using Place = std::variant<std::monostate, std::string, Triple>;  // Of the scene: a node, or where it is.

Direction direction(const Triple& t) { return {t[0], t[1], t[2]}; }

std::optional<std::variant<Direction, std::string>> place_of(const Place& place) {
  if (const auto* const point = std::get_if<Triple>(&place)) return direction(*point);
  if (const auto* const name = std::get_if<std::string>(&place)) return *name;
  return {};
}

// An axis where the word is one, else what the map looks at.
void look_towards(const Place& forward, RenderOptions& o) {
  const auto* const word = std::get_if<std::string>(&forward);
  const auto axis = word ? forward_named(*word) : std::nullopt;
  if (!axis) {
    o.towards = place_of(forward);
    return;
  }
  if (!has_forward(o.to.projection))
    throw UsageError("forward: an axis is for latlong and angular maps; others take a node, (x, y, z) or camera");
  o.to.forward = *axis;
}

Map render_map(const std::filesystem::path& file, const std::string& to, const Place& at, int size, int samples,
               const py::object& around_it, const std::optional<Triple>& ambient, const Place& forward, double near,
               double far, double time, const std::string& method, bool shadows, int occlusion,
               const std::string& context, const py::object& progress) {
  RenderOptions o{.to = projection_of(to),
                  .size = size,
                  .samples = samples,
                  .at = place_of(at).value_or(Direction(0)),
                  .near_metres = near,
                  .far_metres = far,
                  .time_seconds = time,
                  .method = named<DrawMethod>("method", method, draw_method_names),
                  .shadows = shadows,
                  .occlusion = occlusion,
                  .context = named<ContextKind>("context", context, context_names)};
  if (ambient) o.ambient = Colour(direction(*ambient));
  look_towards(forward, o);
  const Map environment = around_it.is_none() ? Map() : around_it.cast<GivenMap>().map;
  RenderedMap made =
      Reporter(progress).run([&](const Run& run) { return render(file.string(), o, environment.get(), run); });
  for (const std::string& remark : made.remarks)  // A filter may make an error of a warning.
    if (PyErr_WarnEx(PyExc_UserWarning, (file.string() + ": " + remark).c_str(), 1) != 0) throw py::error_already_set();
  return std::make_shared<EnvironmentMap>(std::move(made.map));
}

}  // namespace

void add_render(py::module_& m) {
  m.def("render", &render_map, "scene"_a, "to"_a = "cube", py::kw_only(), "at"_a = Place(), "size"_a = 256,
        "samples"_a = 1, "environment"_a = py::none(), "ambient"_a = py::none(), "forward"_a = Place(), "near"_a = 0.01,
        "far"_a = 1000.0, "time"_a = 0.0, "method"_a = "auto", "shadows"_a = true, "occlusion"_a = 64,
        "context"_a = "auto", "progress"_a = py::none(),
        document("render",
                 "scene, to='cube', *, at=None, size=256, samples=1, environment=None, ambient=None, forward=None, "
                 "near=0.01, far=1000.0, "
                 "time=0.0, method='auto', shadows=True, occlusion=64, context='auto', progress=None",
                 "The map of a scene (a file: glTF, OBJ) round a point (x, y, z) or a node, which is then left out."));
}

}  // namespace envmap_python
