/// @file
/// Colour spaces by name, through OpenColorIO: those of a config file, or of a small config of our own.
#pragma once

#include <array>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "envmap/base/export.h"
#include "envmap/maths/primaries.h"
#include "envmap/maths/vector.h"

namespace ENVMAP_EXPORT envmap {

/// How values of a file relate to those of the map in memory. Names are those of colour spaces, aliases and roles of
/// the config; capitals do not matter.
struct ColourOptions {
  std::string config = {};   ///< An OpenColorIO config file. Empty: the built-in config, see colour_spaces().
  std::string space = {};    ///< Of the file. Empty: what it says, then linear Rec.709 of floats and sRGB of integers.
  std::string working = {};  ///< Of the map in memory: a linear one. Empty: linear Rec.709.
};

/// A space that the caller did not name: one of the built-in config, or by its primaries alone.
struct ClaimedSpace {
  std::string name = {};  ///< Empty where none of the config has these primaries.
  std::optional<Primaries> primaries = {};
  std::string by = {};   ///< What says so, for people: "chromaticities".
  bool decoded = false;  ///< Reading undid the curve of the space: values are linear light of its primaries.
};

/// "ACEScg (chromaticities)", "primaries 0.64,0.33 ..."; of nothing said "Linear Rec.709 (assumed, not specified in the
/// file)".
std::string words(const ClaimedSpace& claimed);

/// Colours in place, from any thread; empty where there is nothing to do.
struct ColourTransform {
  std::function<void(std::span<Colour>)> apply = {};
  std::vector<std::string> files = {};  ///< That were read for it: the config and its tables.
  std::string note = {};                ///< What had to be taken for granted.
};

/// @return the names of a config's spaces. @param config empty: those of the built-in one: linear Rec.709, sRGB,
/// ACEScg, ACES2065-1, linear Rec.2020, XYZ, linear P3-D65, Display P3. @throws InputError where it cannot be read.
std::vector<std::string> colour_spaces(const std::string& config = {});

/// From the space of a file, `options.space` where it is set and else what the file claims, to that of the map.
/// @throws UsageError where the config has no such space, with those of a like name.
ColourTransform into_working(const ColourOptions& options, const ClaimedSpace& claimed);

/// From the space of the map to `options.space`. @throws as into_working().
ColourTransform out_of_working(const ColourOptions& options);

/// From the space of the map to what a screen is sent, encoded: a view of a config's display. @param view VIEW, of the
/// config's default display, or DISPLAY:VIEW; empty: its default. @throws UsageError where the config has none of that
/// name, as the built-in one has none at all.
ColourTransform into_view(const ColourOptions& options, const std::string& view);

/// The linear space to work in where `space` shall be written, so that no colour that it holds is lost on the way: the
/// space itself, or that with its primaries; empty (linear Rec.709) where the config has none.
/// @throws as into_working().
std::string working_space_for(const std::string& config, const std::string& space);

/// Primaries of a space, found by what it makes of red, green and blue; nothing where it is not linear (sRGB's curve
/// alone is looked through). @param space empty: linear Rec.709. @throws as into_working().
std::optional<Primaries> primaries_of(const std::string& config, const std::string& space);

/// A space in one word that built-in names and aliases know; empty where there is none.
std::string space_word(const std::string& config, const std::string& space);

/// The name of the built-in linear space with these primaries, or an empty one.
std::string space_with(const Primaries& primaries);

/// The name of the built-in space with these primaries and sRGB's curve, or an empty one.
std::string encoded_space_with(const Primaries& primaries);

/// How the values of a space grow with light.
enum class Curve { linear, srgb, other };

/// @param space empty: linear Rec.709. @throws as into_working().
Curve curve_of(const std::string& config, const std::string& space);

std::array<float, 8> chromaticities(const Primaries& p);
Primaries primaries(const std::array<float, 8>& chromaticities);

}  // namespace envmap
