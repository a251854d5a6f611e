// What a preview shows of a map.
#pragma once

#include <functional>
#include <optional>
#include <span>

#include "drawing/contact_sheet.h"
#include "drawing/luminances.h"
#include "envmap/map/environment_map.h"

namespace tools {

// Radiance, in place, as it is stored: exposed, tone mapped, encoded.
using Show = std::function<void(std::span<envmap::Colour>)>;

// Faces in their layout, cubes as a cross; or one face alone.
class MapPicture {
 public:
  MapPicture(const envmap::Level& level, std::optional<int> face, const Show& show, int height);

  // The axes of the world where the map shows them, rings round its lights, dots along the horizon, and names of the
  // faces where there are several.
  void mark(const envmap::EnvironmentMap& map, std::span<const envmap::Direction> lights);

  [[nodiscard]] Picture& picture() { return picture_; }

 private:
  // Where a direction of the world is drawn, in pixels; nothing where its face is not shown.
  [[nodiscard]] std::optional<envmap::Point2> place(const envmap::Rotation& to_image, const envmap::Direction& d) const;

  envmap::Projection projection_;
  std::optional<int> face_;
  Picture picture_;
};

// What the map lights, as seen from the axis at the middle of its image (+Z) and without perspective, as a mirror ball
// is: a mirror, GGX of three roughnesses with n = v = r, white diffuse.
TileRow lit_balls(const envmap::EnvironmentMap& map, const Show& show, int size);

// Shares of the sphere as bars and of the light as a line, over luminance in stops; a white line where `white` is.
Picture histogram(const Luminances& luminances, double white, envmap::Size size);

}  // namespace tools
