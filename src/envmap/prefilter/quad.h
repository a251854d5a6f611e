/// @file
/// Four lights at once, and what directions that look at them may take them for.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

#include "envmap/prefilter/light.h"
#include "envmap/prefilter/lobe.h"

namespace envmap {

/// What the walk through the tree has to know of four lights that lie side by side.
struct alignas(16) Quad {
  using Lanes = std::array<float, 4>;
  Lanes x, y, z;  ///< Centres.
  Lanes reach, spread, uneven;
  std::array<Lanes, light_channels> flux;

  /// Far below any horizon.
  static Quad none() {
    Quad q{};
    q.x.fill(9), q.y.fill(9), q.z.fill(9);
    return q;
  }
  /// @param from what the centre is counted from.
  void set(std::size_t lane, const Light& light, const Direction& from = Direction(0));
};

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

/// What a view makes of four lights; a bit each.
struct Verdict {
  unsigned visible = 0;             ///< Above the horizon.
  unsigned good = 0;                ///< And good enough.
  alignas(16) Quad::Lanes error{};  ///< Remainders of the lobe's series, relative to the result.
  alignas(16) Quad::Lanes least{};  ///< The lobe, at least.
};

/// A light is taken as two, one standard deviation to either side, which is right but for the third term of Taylor's series
/// of the lobe about its mean cosine. That is bounded by the lobe's third derivative and the light's spread, and by the
/// second for what a channel spreads otherwise than all of them; where the horizon crosses the light, by a part of what the
/// lobe is there; and always by what the lobe changes over it.
/// @param centres from the view's middle.
Verdict judge(const Lobe& lobe, const View& view, const Quad& quad);

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
