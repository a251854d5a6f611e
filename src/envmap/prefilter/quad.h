/// @file
/// Lights side by side, and what directions that look at them may take them for.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

#include "envmap/prefilter/light.h"
#include "envmap/prefilter/lobe.h"

namespace envmap {

/// What the walk through the tree has to know of some lights, side by side.
template <std::size_t N>
struct alignas(4 * N) Heads {
  using Lanes = std::array<float, N>;
  std::array<Lanes, 3> centre;
  Lanes reach, spread, uneven;
  std::array<Lanes, light_channels> flux;

  /// Far below any horizon.
  static Heads none() {
    Heads h{};
    for (Lanes& x : h.centre) x.fill(9);
    return h;
  }
  /// @param from what the centre is counted from.
  void set(std::size_t lane, const Light& light, const Direction& from = Direction(0)) {
    for (std::size_t n = 0; n < 3; ++n)
      centre[n][lane] = static_cast<float>(light.centre[static_cast<int>(n)] - from[static_cast<int>(n)]);
    reach[lane] = light.reach, spread[lane] = light.spread, uneven[lane] = light.uneven;
    for (std::size_t c = 0; c < light_channels; ++c) flux[c][lane] = light.flux[c];
  }
};
using Quad = Heads<4>;
using Bunch = Heads<16>;  ///< What is judged at once.

/// Directions near each other, and what is good enough for them.
struct View {
  Direction middle;   ///< A unit vector.
  double radius = 0;  ///< No direction is farther from the middle.
  LightFlux most{};   ///< 1 over the least that any direction gets of a channel.
  float limit = 0;    ///< What a light may be off, relative to that.
  /// Looks for the least that directions get: a light is good where the lobe changes by less than the limit over it.
  bool surveying = false;
  std::size_t most_lights = SIZE_MAX;  ///< There is no use for more.
};

/// What a view makes of a bunch of lights; a bit each.
struct Verdict {
  unsigned visible = 0;            ///< Above the horizon.
  unsigned good = 0;               ///< And good enough.
  alignas(64) Bunch::Lanes error;  ///< Remainders of the lobe's series, relative to the result, of good ones.
  alignas(64) Bunch::Lanes least;  ///< The lobe, at least, while surveying.
};

/// A light is taken as two, one standard deviation to either side, which is right but for the third term of Taylor's series
/// of the lobe about its mean cosine. That is bounded by the lobe's third derivative and the light's spread, and by the
/// second for what a channel spreads otherwise than all of them; where the horizon crosses the light, by a part of what the
/// lobe is there; and always by what the lobe changes over it.
/// @param lights their centres from the view's middle. @param count of them that are asked for.
Verdict judge(const Lobe& lobe, const View& view, const Bunch& lights, std::size_t count);

class LightTree;

/// A block of the lowest level that is not good enough.
struct Opened {
  int face, i, j;
};

/// What a walk down the stored blocks found. Kept between walks for its memory.
struct Walked {
  std::vector<const Light*> lights;
  std::vector<Opened> opened;
  double sum, power;  ///< Of the remainders, and of their squares.
  LightFlux got;      ///< What directions get at least of the lights.
  std::size_t count;  ///< Of good lights, those below the stored blocks among them.

  void add_error(float error) {
    ++count;
    sum += error;
    power += static_cast<double>(error) * error;
  }
  void add_least(View& view, const LightFlux& flux, float value) {
    for (std::size_t c = 0; c < light_channels; ++c) {
      got[c] += value * flux[c];
      if (c < 3) view.most[c] = std::min(view.most[c], 1 / got[c]);
    }
  }
};

/// Goes down from the largest blocks until they are good, or the lowest. @param view while surveying `most` falls with what
/// is found. Stops early where there are more lights than of use.
void walk(const LightTree& tree, const Lobe& lobe, View& view, Walked& found);

}  // namespace envmap
