// envmap.render(): what `envmap render` does, of one moment.
#include "envmap/render/choose.h"
#include "envmap/render/context.h"
#include "envmap/render/raycast.h"
#include "envmap/render/renderer.h"
#include "envmap/render/turn.h"
#include "envmap/scene/deform.h"
#include "envmap/scene/read/read_scene.h"

#include <pybind11/pybind11.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <algorithm>
#include <memory>
#include <variant>

#include "words.h"

namespace envmap_python {
namespace {

namespace py = pybind11;
using namespace py::literals;
using namespace envmap;

using Place = std::variant<std::monostate, std::string, Triple>;  // Of the scene: a node, or where it is.

Direction direction(const Triple& t) { return {t[0], t[1], t[2]}; }

// As a Python warning, which a filter may make an error.
void warn(const std::string& line) {
  if (PyErr_WarnEx(PyExc_UserWarning, line.c_str(), 1) != 0) throw py::error_already_set();
}

// What the scene's file holds and the map will not show, and whether it will be black.
void tell_shortcomings(const Scene& scene, const std::string& path, bool lit) {
  for (const std::string& what : scene.remarks) warn(path + ": " + what);
  for (const std::string& what : scene.unmodelled) warn(path + ": not drawn: " + what);
  const auto glows = [](const Material& m) { return m.emissive != Colour(0); };
  if (!lit && scene.lights.empty() && std::ranges::none_of(scene.materials, glows))
    warn(path + ": no light in it and none given, so it is black: say environment= or ambient=");
}

void stand_at(Viewpoint& from, const Place& at, const Scene& scene, const Pose& pose, const std::string& path) {
  if (const auto* const place = std::get_if<Triple>(&at)) from.at = direction(*place);
  if (const auto* const name = std::get_if<std::string>(&at)) {
    const auto node = find_node(scene, *name);
    if (!node) throw UsageError("at: '" + *name + "' is no node of " + path);
    from.without = *node;
    from.at = centre_of(scene, pose, *node);
  }
}

// @return the axis at the centre of the image.
Forward look_towards(Viewpoint& from, const Place& forward, const Scene& scene, const Pose& pose,
                     const std::string& path) {
  if (const auto* const along = std::get_if<Triple>(&forward)) {
    from.axes = turned_to(direction(*along));
  } else if (const auto* const name = std::get_if<std::string>(&forward)) {
    if (const auto axis = forward_named(*name)) {
      if (!has_forward(from.to))
        throw UsageError("forward: an axis is for latlong and angular maps; others take a node, (x, y, z) or camera");
      from.axes = image_to_world(*axis);
      return *axis;
    }
    const auto there = direction_to(scene, pose, from.at, *name);
    if (!there)
      throw UsageError("forward: '" + *name + "' is no axis (+z, -z, +x, -x), no node of " + path + " and no camera");
    from.axes = turned_to(*there);
  }
  return Forward::plus_z;
}

DrawMethod method_for(const std::string& word, const Viewpoint& from, const Scene& scene, ContextKind context) {
  const auto method = named<DrawMethod>("method", word, draw_method_names);
  if (!can_draw(method, from.to))
    throw UsageError("method '" + word + "' cannot draw " + std::string(name(from.to)) +
                     " maps: resample or raycast can");
  if (method == DrawMethod::raycast && context != ContextKind::automatic)
    throw UsageError("a context is for OpenGL, which the method 'raycast' does not use");
  if (method != DrawMethod::automatic) return method;
  return cheapest(from.to, from.size, triangles(scene), {}, context == ContextKind::automatic);
}

Drawn drawn(const Shot& shot, const Viewpoint& from, DrawMethod method, ContextKind kind, const Progress& progress) {
  if (method == DrawMethod::raycast) return raycast(shot, from, {}, progress);
  const Context context(kind);
  Renderer renderer(shot.scene, shot.environment);
  return draw(renderer, from, shot, method);
}

void check(const Viewpoint& from, int occlusion) {
  if (from.size < 1 || from.size > 65536) throw UsageError("a size is 1 to 65536");
  if (from.samples < 1 || from.samples > 1024) throw UsageError("samples are 1 to 1024");
  if (!(from.near > 0 && from.near < from.far)) throw UsageError("near is above 0 and below far");
  if (occlusion < 0 || occlusion > most_distant_lights)
    throw UsageError("occlusion is 0 to " + std::to_string(most_distant_lights));
}

Map render(const std::filesystem::path& file, const std::string& to, const Place& at, int size, int samples,
           const py::object& around_it, const std::optional<Triple>& ambient, const Place& forward, double near,
           double far, double time, const std::string& method, bool shadows, int occlusion, const std::string& context,
           const py::object& progress) {
  Viewpoint from{.to = projection_of(to), .size = size, .near = near, .far = far, .samples = samples};
  check(from, occlusion);
  const Map environment = around_it.is_none() ? Map() : around_it.cast<GivenMap>().map;
  const std::string path = file.string();
  const auto kind = named<ContextKind>("context", context, context_names);
  Scene scene = [&] {
    const py::gil_scoped_release others;
    return read_scene(path);
  }();
  deform(scene, pose(scene, time), time);
  tell_shortcomings(scene, path, environment || ambient);
  Shot shot{.scene = scene,
            .pose = pose(scene, time),
            .ambient = Colour(direction(ambient.value_or(Triple{}))),
            .shadows = shadows};
  stand_at(from, at, scene, shot.pose, path);
  const Forward axis = look_towards(from, forward, scene, shot.pose, path);
  const DrawMethod how = method_for(method, from, scene, kind);
  return Reporter(progress).run([&](const Progress& p) {
    std::unique_ptr<const Environment> around;
    std::vector<DistantLight> distant;
    if (environment) {
      EnvironmentMap copy{.levels = {}, .forward = environment->forward};
      copy.levels.push_back(environment->base().clone());
      around = std::make_unique<const Environment>(std::move(copy));
      if (occlusion > 0) distant = distant_lights(around->map, occlusion);
    }
    shot.environment = around.get();
    shot.distant = distant;
    EnvironmentMap map = drawn(shot, from, how, kind, p).radiance;
    map.forward = axis;
    return std::make_shared<EnvironmentMap>(std::move(map));
  });
}

}  // namespace

void add_render(py::module_& m) {
  m.def("render", &render, "scene"_a, "to"_a = "cube", py::kw_only(), "at"_a = Place(), "size"_a = 256, "samples"_a = 1,
        "environment"_a = py::none(), "ambient"_a = py::none(), "forward"_a = Place(), "near"_a = 0.01,
        "far"_a = 1000.0, "time"_a = 0.0, "method"_a = "auto", "shadows"_a = true, "occlusion"_a = 64,
        "context"_a = "auto", "progress"_a = py::none(),
        document("render",
                 "scene, to='cube', *, at=None, size=256, samples=1, environment=None, ambient=None, forward=None, "
                 "near=0.01, far=1000.0, "
                 "time=0.0, method='auto', shadows=True, occlusion=64, context='auto', progress=None",
                 "The map of a scene (a file: glTF, OBJ) round a point (x, y, z) or a node, which is then left out."));
}

}  // namespace envmap_python
