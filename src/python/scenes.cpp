// Scenes and lights that are kept, and what is drawn of them: maps, pictures, grids.
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
using KeptScene = std::shared_ptr<const Scene>;
using KeptLight = std::shared_ptr<const Light>;

KeptScene kept(Scene&& scene) { return std::make_shared<const Scene>(std::move(scene)); }

KeptScene read_scene(const std::string& file, bool allow_missing) {
  return run_operation([=] { return kept(Scene::read(file, {.allow_missing = allow_missing})); });
}

// The bytes are copied: a call that a signal ends leaves its task behind.
KeptScene read_scene_bytes(const py::buffer& file, const std::string& folder, bool allow_missing) {
  const py::buffer_info bytes = file.request();
  const auto* const first = static_cast<const std::byte*>(bytes.ptr);
  const auto copy = std::make_shared<const std::vector<std::byte>>(first, first + bytes.size * bytes.itemsize);
  return run_operation([=] { return kept(Scene::read(*copy, {.allow_missing = allow_missing, .folder = folder})); });
}

KeptLight light_of(const Map& map, bool suns, const py::object& progress) {
  return run_operation(progress, [=](const Run& run) {
    return std::make_shared<const Light>(suns ? Light::with_suns(map->clone(), {}, run) : Light(map->clone(), run));
  });
}

py::tuple corners(const SceneBox& box) { return py::make_tuple(tuple(Flux(box.low)), tuple(Flux(box.high))); }

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

// @return of each place the map, the method, what is missing, and remarks.
py::list render_maps(const KeptScene& scene, const std::string& to, const std::vector<Place>& at, int size, int samples,
                     const KeptLight& light, const std::optional<Triple>& ambient, const Place& forward, double near,
                     double far, double time, const std::string& method, bool shadows, int occlusion,
                     const std::string& context, const py::object& progress) {
  RenderOptions o{.to = projection_of(to),
                  .size = size,
                  .samples = samples,
                  .near_metres = near,
                  .far_metres = far,
                  .time_seconds = time,
                  .method = named<DrawMethod>("method", method, draw_method_names),
                  .shadows = shadows,
                  .occlusion = occlusion,
                  .context = named<ContextKind>("context", context, context_names)};
  if (ambient) o.ambient = Colour(direction(*ambient));
  look_towards(forward, o);
  std::vector<ScenePlace> places;
  for (const Place& place : at) places.push_back(place_of(place).value_or(Direction(0)));
  py::list all;
  for (RenderedMap& made :
       run_operation(progress, [=](const Run& run) { return scene->maps(places, o, light.get(), run); }))
    all.append(py::make_tuple(shared(std::move(made.map)), std::string(draw_method_names[std::size_t(made.method)]),
                              made.missing_solid_angle, made.remarks));
  return all;
}

// @return cells, corners, coefficients (z, y, x, 9, 3), validity (z, y, x), error and remarks.
py::tuple grid_of(const KeptScene& scene, const std::array<int, 3>& cells,
                  const std::optional<std::array<Triple, 2>>& box, int size, int places, const KeptLight& light,
                  const std::optional<Triple>& ambient, double far, double time, bool shadows, int occlusion,
                  const py::object& progress) {
  GridOptions o{.cells = cells,
                .size = size,
                .error_places = places,
                .far_metres = far,
                .time_seconds = time,
                .shadows = shadows,
                .occlusion = occlusion};
  if (box) o.box = SceneBox{direction((*box)[0]), direction((*box)[1])};
  if (ambient) o.ambient = Colour(direction(*ambient));
  const IrradianceGrid made =
      run_operation(progress, [=](const Run& run) { return irradiance_grid(*scene, o, light.get(), run); });
  const py::array::ShapeContainer shape{cells[2], cells[1], cells[0]}, nine{cells[2], cells[1], cells[0], 9, 3};
  return py::make_tuple(corners(made.box), py::array_t<double>(nine, &made.light.front().front().x),
                        py::array_t<double>(shape, made.validity.data()), made.error.places, made.error.rms,
                        made.error.max, made.remarks);
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

py::tuple view_scene(const KeptScene& scene, const Place& camera, const std::optional<Triple>& look_at,
                     const std::optional<double>& fov, int width, int height, int samples, const KeptLight& light,
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
  return tuple_of(run_operation(progress, [=](const Run& run) { return scene->view(o, light.get(), run); }));
}

}  // namespace

void add_scenes(py::module_& m) {
  py::class_<Light, std::shared_ptr<Light>>(m, "Light");
  py::class_<Scene, std::shared_ptr<Scene>>(m, "Scene")
      .def("nodes", &Scene::nodes)
      .def("remarks", &Scene::remarks)
      .def("box", [](const Scene& scene, double time) { return corners(scene.box(time)); })
      .def("render", &render_maps)
      .def("view", &view_scene)
      .def("grid", &grid_of);
  m.def("read_scene", &read_scene);
  m.def("read_scene_bytes", &read_scene_bytes);
  m.def("light", &light_of);
}

}  // namespace envmap_python
