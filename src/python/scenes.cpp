// envmap.render() and view(): pictures and maps of scenes.
#include "envmap/scenes.h"

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <variant>

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
    if (const auto* const along = std::get_if<Triple>(&forward)) (void)direction_of("forward", *along);
    o.towards = place_of(forward);
    return;
  }
  if (!has_forward(o.to.projection))
    throw UsageError("forward: an axis is for latlong and angular maps; others take a node, (x, y, z) or camera");
  o.to.forward = *axis;
}

// A filter may make an error of a warning.
void warn_of(const std::filesystem::path& file, const std::vector<std::string>& remarks) {
  for (const std::string& remark : remarks)
    if (PyErr_WarnEx(PyExc_UserWarning, (file.string() + ": " + remark).c_str(), 1) != 0) throw py::error_already_set();
}

Map environment_of(const py::object& given) { return given.is_none() ? Map() : given.cast<GivenMap>().map; }

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
  const Map environment = environment_of(around_it);
  RenderedMap made =
      Reporter(progress).run([&](const Run& run) { return render(file.string(), o, environment.get(), run); });
  warn_of(file, made.remarks);
  return shared(std::move(made.map));
}

// What view() gives.
struct Picture {
  py::array_t<float> array;  // (height, width, 3).
  py::dict mirrors;
  std::string method;
  std::optional<double> error;
};

// Of {node: projection, 'off', or None for that of the others}.
std::vector<MirrorWish> wishes_of(const py::dict& mirrors) {
  std::vector<MirrorWish> all;
  for (const auto& [node, how] : mirrors) {
    MirrorWish wish{cast_to<std::string>(node, "a key of mirrors", "the name of a node")};
    if (!how.is_none()) {
      const auto word = cast_to<std::string>(how, "mirrors['" + wish.node + "']", "a word or None");
      wish.off = word == "off";
      if (!wish.off) wish.map = projection_of(word);
    }
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

Picture picture_of(ViewedScene&& viewed) {
  Picture picture{.array = py::array_t<float>({viewed.height, viewed.width, 3}, &viewed.radiance.front().x),
                  .mirrors = {},
                  .method = std::string(view_method_names[std::size_t(viewed.method)]),
                  .error = viewed.error};
  for (ViewedMirror& mirror : viewed.mirrors)
    if (!mirror.map.levels.empty())
      picture.mirrors[py::str(name_of(mirror, picture.mirrors))] = shared(std::move(mirror.map));
  return picture;
}

Picture view_scene(const std::filesystem::path& file, const Place& camera, const std::optional<Triple>& look_at,
                   const std::optional<double>& fov, int width, int height, int samples, const py::object& around_it,
                   const std::optional<Triple>& ambient, const std::string& method, const std::string& maps,
                   const py::dict& mirrors, const std::optional<double>& max_error, const std::optional<int>& bounces,
                   double time, const std::string& reflection, const std::string& context, const py::object& progress) {
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
  const Map environment = environment_of(around_it);
  ViewedScene viewed =
      Reporter(progress).run([&](const Run& run) { return view(file.string(), o, environment.get(), run); });
  warn_of(file, viewed.remarks);
  return picture_of(std::move(viewed));
}

}  // namespace

void add_scenes(py::module_& m) {
  py::class_<Picture>(m, "Picture", "What view() drew, and how.")
      .def_readonly("array", &Picture::array, "Linear radiance, (height, width, 3), rows from the top.")
      .def_readonly("mirrors", &Picture::mirrors,
                    "The map of each mirror that is seen, by its node's name; 'NAME (node K)' where the name is taken.")
      .def_readonly("method", &Picture::method, "maps or raycast.")
      .def_readonly("error", &Picture::error, "Of the picture against rays, where max_error was given.");
  m.def(
      "view", &view_scene, "scene"_a, py::kw_only(), "camera"_a = Place(), "look_at"_a = py::none(),
      "fov"_a = py::none(), "width"_a = 640, "height"_a = 480, "samples"_a = 4, "environment"_a = py::none(),
      "ambient"_a = py::none(), "method"_a = "maps", "maps"_a = "paraboloid", "mirrors"_a = py::dict(),
      "max_error"_a = py::none(), "bounces"_a = py::none(), "time"_a = 0.0, "reflection"_a = "split-sum",
      "context"_a = "auto", "progress"_a = py::none(),
      document("view",
               "scene, *, camera=None, look_at=None, fov=None, width=640, height=480, samples=4, environment=None, "
               "ambient=None, method='maps', maps='paraboloid', mirrors={}, max_error=None, bounces=None, time=0.0, "
               "reflection='split-sum', context='auto', progress=None",
               "A picture of a scene (a file: glTF, OBJ), with mirrors and lenses drawn through maps of their own.\n\n"
               "camera is a name or a point (x, y, z), fov the vertical field of view in degrees. mirrors has "
               "{node: 'sphere', 'paraboloid', 'cube' or 'off'} for nodes whose material does not say so. "
               "reflection='sampled' is "
               "accurate on rough surfaces at grazing angles."));
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
