/// @file
/// Images as files hold them, written and read without the library under test, and what they should show.
#pragma once

#include <OpenImageIO/imageio.h>

#include <array>
#include <string>
#include <vector>

namespace command_tests {

using Vec = std::array<double, 3>;

/// Float values of an image, top row first.
struct Picture {
  int width = 0, height = 0, channels = 3;
  std::vector<float> values;

  /// @param fill of every value.
  static Picture filled(int width, int height, float fill = 0, int channels = 3);

  float* at(int x, int y) {
    return values.data() + (std::size_t(y) * std::size_t(width) + std::size_t(x)) *
                               std::size_t(channels);
  }
  const float* at(int x, int y) const { return const_cast<Picture*>(this)->at(x, y); }
  bool operator==(const Picture&) const = default;
};

/// Writes with OpenImageIO, and PFM by hand. @param spec what is said beside the size: channel names, attributes.
void save(const std::string& path, const Picture& picture, OIIO::TypeDesc type = OIIO::TypeDesc::FLOAT,
          OIIO::ImageSpec spec = {});

/// The values as they are stored: integers from 0 to 1, no curve undone.
Picture load(const std::string& path);

/// Largest difference of two values; infinite where sizes differ.
double difference(const Picture& a, const Picture& b);

/// What `generate directions` shows towards d, which need not be of unit length.
std::array<float, 3> colour_of(const Vec& d);

/// The directions map as latlong, +Z at its centre. @param border samples on the border, as OpenEXR's envmap has them.
Picture latlong_directions(int height, bool border = false);

/// The directions map as a cube of this layout (column, row, cross, vcross or 3x2), each face placed by hand:
/// in the vertical cross +Z hangs below -Y and so stands on its head.
Picture cube_directions(const std::string& layout, int size);

/// One face of it, 0 to 5 for +X -X +Y -Y +Z -Z.
Picture face_directions(int face, int size);

}  // namespace command_tests
