// envmap.generate(): patterns by their names and parameters.
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include "words.h"

namespace envmap_python {
namespace {

namespace py = pybind11;
using namespace py::literals;
using namespace envmap;

template <class T>
constexpr const char* words_for = "three numbers";
template <>
constexpr const char* words_for<int> = "a whole number below 2^31";
template <>
constexpr const char* words_for<double> = "a number";
template <>
constexpr const char* words_for<bool> = "True or False";
template <>
constexpr const char* words_for<std::string> = "a word";

// A parameter of a pattern, taken out of what was given.
template <class T>
T take(py::kwargs& given, const char* name, const T& otherwise) {
  if (!given.contains(name)) return otherwise;
  const T value = cast_to<T>(given[name], name, words_for<T>);
  given.attr("pop")(name);
  return value;
}

// A number is all three channels: an array counts as a number, too, and as a sequence.
Rgb<double> take(py::kwargs& given, const char* name, const Rgb<double>& otherwise) {
  if (given.contains(name) && PyNumber_Check(given[name].ptr()) == 1 && PySequence_Check(given[name].ptr()) == 0)
    return Rgb<double>(take(given, name, 0.0));
  return rgb(take(given, name, triple(otherwise)));
}

Direction direction(py::kwargs& k, const Direction& otherwise) {
  return glm::normalize(direction_of("direction", take(k, "direction", triple(otherwise))));
}

// The radius of a sun, in degrees.
double radius(py::kwargs& k, double otherwise, const Bounds& range) {
  const double degrees = take(k, "radius", otherwise);
  check_range({"radius", range.least, range.most}, degrees);
  return degrees;
}

Sky sky_of(py::kwargs& k) {
  Sky sky{take(k, "zenith", Rgb<double>(1)), take(k, "ground", Rgb<double>(0.2))};
  if (k.contains("horizon")) sky.horizon = take(k, "horizon", Rgb<double>(0));
  return sky;
}

Pattern pattern(const std::string& kind, py::kwargs& k) {
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

Atmosphere atmosphere(py::kwargs& k) {
  Atmosphere a;
  a.sun = direction(k, a.sun);
  a.turbidity = take(k, "turbidity", a.turbidity), a.altitude = take(k, "altitude", a.altitude);
  a.ground = take(k, "ground", a.ground), a.radius_degrees = radius(k, a.radius_degrees, limits::sun_radius);
  a.disc = take(k, "disc", a.disc);
  const std::string scattering = take(k, "scattering", std::string("multiple"));
  if (scattering != "single" && scattering != "multiple") throw UsageError("scattering is 'single' or 'multiple'");
  a.scattering = scattering == "single" ? Scattering::single : Scattering::multiple;
  return a;
}

// What is left of the parameters is of no kind.
void check_taken(const std::string& kind, const py::kwargs& left) {
  if (left.size() > 0) throw UsageError(kind + " has no parameter " + py::cast<std::string>(left.begin()->first));
}

Map generate_map(const std::string& kind, const std::string& to, int size, const std::string& forward,
                 py::kwargs parameters) {
  const Frame frame(projection_of(to), forward_of(forward));
  if (kind == "atmosphere") {
    const Atmosphere air = atmosphere(parameters);
    check_taken(kind, parameters);
    const py::gil_scoped_release others;
    return shared(generate(air, frame, size).map);
  }
  const Pattern wanted = pattern(kind, parameters);
  check_taken(kind, parameters);
  const py::gil_scoped_release others;
  return shared(generate(wanted, frame, size));
}

}  // namespace

void add_generate(py::module_& m) {
  m.def("generate", &generate_map, "kind"_a, "to"_a = "latlong", "size"_a = 64, "forward"_a = "+z",
        document("generate", "kind, to='latlong', size=64, forward='+z', **parameters",
                 "An environment with a known answer: constant, gradient, checker, directions, faces, sun, sky or sh, "
                 "with its parameters. 'atmosphere' is a clear day: direction, turbidity, altitude, ground, radius, "
                 "disc and scattering are as in envmap-generate(1)."));
}

}  // namespace envmap_python
