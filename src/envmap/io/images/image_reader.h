/// @file
/// An image opened for reading, whichever library reads it.
#pragma once

#include <array>
#include <functional>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "envmap/base/export.h"
#include "envmap/io/claims/claim.h"
#include "envmap/io/claims/colour.h"
#include "envmap/io/images/depth.h"

namespace ENVMAP_EXPORT envmap {

/// Texts that a file carries, by name; its description under `description`.
using Attributes = std::map<std::string, std::string>;
inline constexpr const char* description = "ImageDescription";
inline constexpr const char* copyright = "Copyright";

/// What a file says of its picture that stays true of any map made of it.
struct Provenance {
  std::string comments = {}, owner = {};
  std::optional<float> white_luminance = {};  ///< Of radiance (1,1,1), in candelas a square metre.
  /// CIE x and y of red, green, blue and white.
  std::optional<std::array<float, 8>> chromaticities = {};
};

/// Which side of the picture the first row and the first column in the file are: numbered as EXIF and TIFF do (TIFF
/// 6.0, "Orientation").
enum class Orientation {
  upright = 1,
  top_right,
  bottom_right,
  bottom_left,
  left_top,
  right_top,
  right_bottom,
  left_bottom
};

/// What the values of a file are, as it says itself by a profile, code points or a gamma.
struct StatedColour {
  ClaimedSpace space = {};  ///< For people; its primaries are those of the light that `decode` makes.
  /// Values as they are stored become linear light, in place. Empty: they are linear.
  std::function<void(std::span<Colour>)> decode = {};
  std::optional<float> white_luminance = {};  ///< Of radiance (1,1,1), where the curve tells it.
  bool fixed = false;  ///< Reading itself made light of the values: the caller cannot name another space.
};

/// What a file says of an image, or of one level of it.
struct ImageFacts {
  int width = 0, height = 0;
  int tile_width = 0, tile_height = 0;  ///< 0: the image is in lines, not in tiles.
  bool flat = true;                     ///< One sample for each pixel and channel: neither deep nor a volume.
  bool encoded = false;                 ///< Its values are sRGB encoded, where `colour` says nothing else.
  bool names = true;                    ///< Channel names tell what channels are; else the first three are R, G and B.
  Depth depth = Depth::single;
  std::vector<std::string> channels = {};  ///< R, G and B, where they are there, follow each other.
  Attributes attributes = {};
  Provenance provenance = {};  ///< The colours alone: texts are attributes.
  std::optional<StatedColour> colour = {};
  std::string icc_profile = {};  ///< That is still to be honoured: honour_profile().
  /// Channels are cyan, magenta, yellow and black, from 0 to 1: how much of an ink is there, or is not.
  enum class Inks { none, there, inverted } inks = Inks::none;
  Orientation orientation = Orientation::upright;
  bool straight_alpha = false;  ///< Colours are not multiplied by alpha, which follows them: decode() comes first.
  int chosen = 0;  ///< So many channels, the first, were asked for: 3, or 1 that is grey. 0: their names tell.
  std::vector<std::string> notes = {};    ///< What of the file is not read, or was added, for people.
  std::vector<std::string> details = {};  ///< What reading did to the values.
  std::vector<Claim> claims = {};         ///< What the file states, beside `orientation` and `provenance`.
};

/// What to read of a file that holds several images, or one for several displays; where a text is empty nothing is
/// said.
struct ImageChoice {
  std::string part = {};                ///< Its name, or its number from 0; else the first.
  std::string layer = {};               ///< The channels LAYER.R, LAYER.G and LAYER.B.
  std::string channels = {};            ///< Three names with commas between them, or one for grey. 1/NAME: reciprocal.
  bool crop = false;                    ///< The data window as the whole image, whatever the display window is.
  std::optional<double> headroom = {};  ///< Of a gain map: stops above white of a display it is for. Empty: all.

  [[nodiscard]] bool of_part() const { return !part.empty() || !layer.empty() || !channels.empty(); }
};

struct ImageReader {
  std::string format;  ///< openexr, hdr, png, ...
  ImageFacts facts;    ///< Of the image and its first level.
  /// Of another level; nothing where there is none. Null: there is but one.
  std::function<std::optional<ImageFacts>(int level)> level = {};
  /// Rows [begin, end) of channels [first, first + count) of a level, interleaved; of tiles whole rows of them.
  /// @throws InputError without the file's name.
  std::function<void(int level, int begin, int end, int first, int count, std::span<float> out)> read;

  /// Of level k; nothing where there is none.
  [[nodiscard]] std::optional<ImageFacts> level_facts(int k) const {
    return level ? level(k) : k == 0 ? std::optional(facts) : std::nullopt;
  }
};

}  // namespace envmap
