// envmap.render() and view(): pictures and maps of scenes.
#include "envmap/scenes.h"

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <variant>

#include "words.h"

namespace envmap_python {
namespace {

namespace py = pybind11;
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
    if (const auto* const along = std::get_if<Triple>(&forward)) (void)direction_of("forward", *along);
    o.towards = place_of(forward);
    return;
  }
  if (!has_forward(o.to.projection))
    throw UsageError("forward: an axis is for latlong and angular maps; others take a node, (x, y, z) or camera");
  o.to.forward = *axis;
}

// @return the map, and remarks.
py::tuple render_map(const std::string& file, const std::string& to, const Place& at, int size, int samples,
                     const Map& environment, const std::optional<Triple>& ambient, const Place& forward, double near,
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
  RenderedMap made = run_operation(progress, [=](const Run& run) { return render(file, o, environment.get(), run); });
  return py::make_tuple(shared(std::move(made.map)), made.remarks);
}

// Of (node, projection, 'off' or None for the projection of the others).
using Mirrors = std::vector<std::pair<std::string, std::optional<std::string>>>;
std::vector<MirrorWish> wishes_of(const Mirrors& mirrors) {
  std::vector<MirrorWish> all;
  for (const auto& [node, how] : mirrors) {
    MirrorWish wish{node};
    wish.off = how == "off";
    if (how && !wish.off) wish.map = projection_of(*how);
    all.push_back(wish);
  }
  return all;
}

// As `envmap view` names the files of maps. @param taken keys.
std::string name_of(const ViewedMirror& mirror, const py::dict& taken) {
  const std::string number = "node " + std::to_string(mirror.number);
  const std::string name = mirror.node.empty() ? number : mirror.node;
  return taken.contains(name) ? name + " (" + number + ")" : name;
}

// @return the picture (height, width, 3), mirrors, method, error and remarks.
py::tuple tuple_of(ViewedScene&& viewed) {
  py::dict mirrors;
  for (ViewedMirror& mirror : viewed.mirrors)
    if (!mirror.map.levels.empty()) mirrors[py::str(name_of(mirror, mirrors))] = shared(std::move(mirror.map));
  return py::make_tuple(py::array_t<float>({viewed.height, viewed.width, 3}, &viewed.radiance.front().x), mirrors,
                        std::string(view_method_names[std::size_t(viewed.method)]), viewed.error, viewed.remarks);
}

py::tuple view_scene(const std::string& file, const Place& camera, const std::optional<Triple>& look_at,
                     const std::optional<double>& fov, int width, int height, int samples, const Map& environment,
                     const std::optional<Triple>& ambient, const std::string& method, const std::string& maps,
                     const Mirrors& mirrors, const std::optional<double>& max_error, const std::optional<int>& bounces,
                     double time, const std::string& reflection, const std::string& context,
                     const py::object& progress) {
  ViewOptions o{.camera = place_of(camera),
                .vertical_field_degrees = fov,
                .width = width,
                .height = height,
                .samples = samples,
                .time_seconds = time,
                .method = named<ViewMethod>("method", method, view_method_names),
                .reflection = named<Reflection>("reflection", reflection, reflection_names),
                .mirrors = wishes_of(mirrors),
                .maps = projection_of(maps),
                .bounces = bounces,
                .max_error = max_error,
                .context = named<ContextKind>("context", context, context_names)};
  if (look_at) o.look_at = direction(*look_at);
  if (ambient) o.ambient = Colour(direction(*ambient));
  return tuple_of(run_operation(progress, [=](const Run& run) { return view(file, o, environment.get(), run); }));
}

}  // namespace

void add_scenes(py::module_& m) {
  m.def("render", &render_map);
  m.def("view", &view_scene);
}

}  // namespace envmap_python
