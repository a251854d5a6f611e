// envmap.generate(): patterns by their names and parameters.
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include "words.h"

namespace envmap_python {
namespace {

namespace py = pybind11;
using namespace envmap;

// What is given for a parameter of a pattern, which Python has checked.
template <class T>
T take(const py::dict& given, const char* name, const T& otherwise) {
  return given.contains(name) ? given[name].cast<T>() : otherwise;
}
Rgb<double> take(const py::dict& given, const char* name, const Rgb<double>& otherwise) {
  return rgb(take(given, name, triple(otherwise)));
}

Direction direction(const py::dict& k, const Direction& otherwise) {
  return glm::normalize(direction_of("direction", take(k, "direction", triple(otherwise))));
}

// The radius of a sun, in degrees.
double radius(const py::dict& k, double otherwise, const Bounds& range) {
  const double degrees = take(k, "radius", otherwise);
  check_range({"radius", range.least, range.most}, degrees);
  return degrees;
}

Sky sky_of(const py::dict& k) {
  Sky sky{take(k, "zenith", Rgb<double>(1)), take(k, "ground", Rgb<double>(0.2))};
  if (k.contains("horizon")) sky.horizon = take(k, "horizon", Rgb<double>(0));
  return sky;
}

Pattern pattern(const std::string& kind, const py::dict& k) {
  if (kind == "constant") return Constant{take(k, "radiance", Rgb<double>(1))};
  if (kind == "gradient") return Gradient{take(k, "bottom", Rgb<double>(0.1)), take(k, "top", Rgb<double>(1))};
  if (kind == "checker")
    return Checker{take(k, "squares", 8), take(k, "even", Rgb<double>(1)), take(k, "odd", Rgb<double>(0.1))};
  if (kind == "directions") return Directions{};
  if (kind == "faces") return Faces{};
  if (kind == "sky") return sky_of(k);
  if (kind == "sh")
    return Harmonic{take(k, "degree", 2), take(k, "order", 0), take(k, "base", 1.0), take(k, "amplitude", 0.5)};
  if (kind != "sun")
    throw UsageError("kind '" + kind +
                     "' is none of constant, gradient, checker, directions, faces, sun, sky, sh, atmosphere");
  const Direction towards = direction(k, Direction(0, 0, 1));
  return Sun{towards, radius(k, 0.2666, limits::disc_radius), take(k, "radiance", Rgb<double>(1e5)), sky_of(k)};
}

Atmosphere atmosphere(const py::dict& k) {
  Atmosphere a;
  a.sun = direction(k, a.sun);
  a.turbidity = take(k, "turbidity", a.turbidity), a.altitude = take(k, "altitude", a.altitude);
  a.ground = take(k, "ground", a.ground), a.radius_degrees = radius(k, a.radius_degrees, limits::sun_radius);
  a.disc = take(k, "disc", a.disc);
  static constexpr std::string_view words[] = {"single", "multiple"};
  const bool is_single = index_of_word("scattering", take(k, "scattering", std::string("multiple")), words) == 0;
  a.scattering = is_single ? Scattering::single : Scattering::multiple;
  return a;
}

Map generate_map(const std::string& kind, const std::string& to, int size, const std::string& forward,
                 const py::dict& parameters) {
  const Frame frame(projection_of(to), forward_of(forward));
  if (kind == "atmosphere") {
    const Atmosphere air = atmosphere(parameters);
    return run_operation([=] { return shared(generate(air, frame, size).map); });
  }
  const Pattern wanted = pattern(kind, parameters);
  return run_operation([=] { return shared(generate(wanted, frame, size)); });
}

}  // namespace

void add_generate(py::module_& m) { m.def("generate", &generate_map); }

}  // namespace envmap_python
