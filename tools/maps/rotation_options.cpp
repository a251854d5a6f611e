#include "maps/rotation_options.h"

#include <fmt/format.h>

#include <cmath>
#include <string>

#include "cli/console.h"
#include "envmap/base/error.h"
#include "envmap/maths/portable.h"
#include "envmap/operate/measure.h"

namespace tools {

using namespace envmap;

namespace {

// An axis such as +x, or X,Y,Z.
std::optional<Direction> direction_of(const std::string& text) {
  const std::size_t axis = text.size() == 2 ? std::string_view("xyz").find(text[1]) : std::string_view::npos;
  if (axis != std::string_view::npos && (text[0] == '+' || text[0] == '-')) {
    Direction d(0);
    d[int(axis)] = text[0] == '+' ? 1 : -1;
    return d;
  }
  const std::optional<Direction> d = triple_of(text);
  const Direction unit_vector = d ? unit(*d) : Direction(0);
  return unit_vector == Direction(0) ? std::nullopt : std::optional(unit_vector);
}

std::optional<Turn> turn_of(const std::string& text) {
  const std::vector<std::string> ends = split(text, ':');
  if (ends.size() == 1) {
    const std::optional<YawPitchRoll> angles = triple_of(text);
    return angles ? std::optional(Turn{.angles = angles}) : std::nullopt;
  }
  if (ends.size() != 2) return std::nullopt;
  const bool sun = ends[0] == "sun";
  const std::optional<Direction> from = sun ? std::nullopt : direction_of(ends[0]), to = direction_of(ends[1]);
  if (!to || !(sun || from)) return std::nullopt;
  return Turn{.from = from, .to = *to};
}

Direction brightest_direction(const EnvironmentMap& map) {
  const Measures m = measure(map);
  if (!(m.brightest > 0)) throw InputError("--rotate sun:TO: all texels are black; give a direction instead of sun");
  return m.brightest_direction;
}

// rotation() of these angles is the rotation.
YawPitchRoll angles_of(const Rotation& r) {
  constexpr double degree = pi / 180;
  const double along = std::sqrt(r[0].y * r[0].y + r[1].y * r[1].y);
  const double pitch = portable::atan2(-r[2].y, along) / degree;
  // Looking straight up or down, yaw and roll turn about the same axis.
  if (along < 1e-9) return {portable::atan2(-r[0].z, r[0].x) / degree, pitch, 0};
  return {portable::atan2(r[2].x, r[2].z) / degree, pitch, portable::atan2(r[0].y, r[1].y) / degree};
}

// -0 looks like a mistake.
std::string words(const YawPitchRoll& angles) {
  return fmt::format("{:.6g},{:.6g},{:.6g}", angles.x + 0.0, angles.y + 0.0, angles.z + 0.0);
}

}  // namespace

void add_rotate(Options& o, std::optional<Turn>& turn) {
  o.add(
      "--rotate", "Y,P,R or FROM:TO",
      [&turn](const std::string& text) {
        turn = turn_of(text);
        if (!turn) throw std::invalid_argument("must be Y,P,R as in 90,0,0, or FROM:TO as in sun:+z, not " + text);
        return true;
      },
      "Yaw, pitch and roll in degrees, or turn FROM to TO, as in sun:+z");
}

Rotation rotation_of(const Turn& turn, const EnvironmentMap& map) {
  if (turn.angles) return rotation(turn.angles->x, turn.angles->y, turn.angles->z);
  const Direction from = turn.from ? *turn.from : brightest_direction(map);
  const Rotation r = upright_about(turn.to) * glm::transpose(upright_about(from));
  note(fmt::format("envmap convert: ({:.5f}, {:.5f}, {:.5f}) turns to ({:.5f}, {:.5f}, {:.5f}): --rotate={}", from.x,
                   from.y, from.z, turn.to.x, turn.to.y, turn.to.z, words(angles_of(r))));
  return r;
}

}  // namespace tools
