// Operations on maps: convert, mip levels, repair, measures, differences, pictures; texels of projections.
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include "words.h"

namespace envmap_python {
namespace {

namespace py = pybind11;
using namespace envmap;

struct Seen {  // What a mirror ball's photo was taken with.
  std::optional<double> distance, field;
};

std::optional<BallCamera> camera_of(const Seen& ball) {
  if (ball.distance && ball.field) throw UsageError("say ball_distance= or ball_fov=, not both");
  if (ball.distance) return BallCamera{*ball.distance};
  if (ball.field) return BallCamera::of_field_of_view(*ball.field);
  return {};
}

Map convert_map(const Map& map, const std::optional<std::string>& to, std::optional<int> size,
                const std::optional<std::string>& filter, int samples, std::optional<double> max_error,
                const Triple& rotate, const std::string& mirror, double gain, const std::optional<std::string>& forward,
                std::optional<double> ball_distance, std::optional<double> ball_fov, const py::object& progress) {
  const Frame from = map->frame();
  ConvertOptions o{.to = {to ? projection_of(*to) : from.projection, forward ? forward_of(*forward)
                                                                     : to    ? Forward::plus_z
                                                                             : from.forward},
                   .size = size,
                   .samples = samples,
                   .max_error = max_error,
                   .rotation = rotation(rotate[0], rotate[1], rotate[2]),
                   .mirror = named<MirroredAxis>("mirror", mirror, mirrored_axis_names),
                   .gain = gain,
                   .ball = camera_of({ball_distance, ball_fov})};
  if (filter) o.filter = filter_of(*filter);
  return run_operation(progress, [=](const Run& run) { return shared(convert(*map, o, run)); });
}

Map mipmap(const Map& map, int levels, const std::string& weights) {
  return run_operation([=, w = weights_of(weights)] {
    EnvironmentMap all{.levels = {}, .forward = map->forward};
    all.levels.push_back(map->base().clone());
    add_levels(all.levels, w, levels);
    return shared(std::move(all));
  });
}

// @return the map, and how many texels were changed.
std::pair<Map, std::int64_t> repair_map(const Map& map) {
  return run_operation([=] {
    EnvironmentMap sound = map->clone();
    std::int64_t changed = 0;
    for (Level& level : sound.levels) changed += repair(level);
    return std::pair{shared(std::move(sound)), changed};
  });
}

// A difference as a tuple: flux, rms, max, worst, worst_level, levels.
py::tuple tuple_of(const Difference& d, int level, py::list levels) {
  return py::make_tuple(tuple(d.flux), d.rms, d.maximum, index_of(d.worst), level, std::move(levels));
}

py::tuple compare_maps(const Map& a, const Map& b) {
  const MapDifference all = run_operation([=] { return compare(*a, *b); });
  py::list levels;
  for (std::size_t k = 0; k < all.levels.size(); ++k) levels.append(tuple_of(all.levels[k], int(k), py::list()));
  return tuple_of(all, all.worst_level, levels);
}

py::dict measures_of(const Map& map, const Triple& towards) {
  using namespace py::literals;
  const Direction normal = direction_of("towards", towards);
  const auto [m, light] = run_operation([=] { return std::pair{measure(*map), irradiance(*map, normal)}; });
  return py::dict("minimum"_a = tuple(m.minimum), "maximum"_a = tuple(m.maximum), "mean"_a = tuple(m.mean),
                  "flux"_a = tuple(m.flux), "solid_angle"_a = m.solid_angle, "darkest"_a = m.darkest,
                  "brightest"_a = m.brightest, "brightest_index"_a = index_of(m.brightest_texel),
                  "brightest_direction"_a = tuple(m.brightest_direction), "brightest_texels"_a = m.brightest_texels,
                  "brightest_value"_a = tuple(Rgb<double>(m.brightest_value)), "irradiance"_a = tuple(light),
                  "illuminance"_a = glm::dot(light, luminance_weights(rec709)));
}

py::array_t<float> picture_of(const Map& map, const std::string& lens, double fov, int width, int height,
                              const Triple& towards, const std::string& filter, std::optional<int> samples,
                              const Triple& rotate, double gain, const py::object& progress) {
  const PhotographOptions o{.lens = named<CameraModel>("lens", lens, camera_model_names),
                            .field_radians = fov / 180 * pi,
                            .width = width,
                            .height = height,
                            .towards = direction_of("towards", towards),
                            .filter = filter_of(filter),
                            .samples = samples,
                            .rotation = rotation(rotate[0], rotate[1], rotate[2]),
                            .gain = gain};
  const std::vector<Colour> pixels =
      run_operation(progress, [=](const Run& run) { return photograph(map->clone(), o, run); });
  return py::array_t<float>({py::ssize_t{height}, py::ssize_t{width}, py::ssize_t{3}}, &pixels.front().x);
}

// Radiance as a screen shows it, linear from 0 to 1. Of an array (n, 3), in place.
void show_pixels(py::array_t<float, py::array::c_style> pixels, const std::string& curve, double exposure) {
  static_assert(sizeof(Colour) == 3 * sizeof(float));
  const auto display = named<Display>("tone", curve, display_names);
  show({reinterpret_cast<Colour*>(pixels.mutable_data()), std::size_t(pixels.shape(0))}, display, exposure);
}

py::array_t<double> solid_angles_of(const std::string& projection, int size) {
  const Projection p = projection_of(projection);
  check_range(limits::size, size);
  const py::ssize_t width = py::ssize_t{size} * aspect(p);
  py::array_t<double> out({py::ssize_t{size}, width});
  for (int j = 0; j < size; ++j) solid_angles(p, size, j, {out.mutable_data(j, 0), std::size_t(width)});
  return out;
}

py::array_t<double> directions_of(const std::string& projection, int size, const std::string& forward) {
  const Frame frame(projection_of(projection), forward_of(forward));
  check_range(limits::size, size);
  const py::ssize_t width = py::ssize_t{size} * aspect(frame.projection);
  const Rotation to_world = image_to_world(frame.forward);
  py::array_t<double> out({py::ssize_t{faces(frame.projection)}, py::ssize_t{size}, width, py::ssize_t{3}});
  auto* const first = reinterpret_cast<Direction*>(out.mutable_data());
  const py::gil_scoped_release others;
  for (int k = 0; k < faces(frame.projection) * size; ++k) {
    const std::span<Direction> row(first + k * width, std::size_t(width));
    texel_directions(frame.projection, size, k / size, k % size, 0, row);
    for (Direction& d : row) d = to_world * d;
  }
  return out;
}

}  // namespace

void add_operations(py::module_& m) {
  m.def("convert", &convert_map);
  m.def("mipmap", &mipmap);
  m.def("repair", &repair_map);
  m.def("compare", &compare_maps);
  m.def("measure", &measures_of);
  m.def("photograph", &picture_of);
  m.def("show", &show_pixels);
  m.def("solid_angles", &solid_angles_of);
  m.def("directions", &directions_of);
}

}  // namespace envmap_python
