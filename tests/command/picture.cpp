#include "picture.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <fstream>
#include <limits>
#include <numbers>
#include <stdexcept>

namespace command_tests {
namespace {

constexpr double pi = std::numbers::pi;

// What lies ahead, to the right and up, seen from inside.
struct Axes {
  Vec forward, right, up;
};

constexpr std::array<Axes, 6> axes{{{{1, 0, 0}, {0, 0, 1}, {0, 1, 0}},     // +X
                                    {{-1, 0, 0}, {0, 0, -1}, {0, 1, 0}},   // -X
                                    {{0, 1, 0}, {1, 0, 0}, {0, 0, 1}},     // +Y
                                    {{0, -1, 0}, {1, 0, 0}, {0, 0, -1}},   // -Y
                                    {{0, 0, 1}, {-1, 0, 0}, {0, 1, 0}},    // +Z
                                    {{0, 0, -1}, {1, 0, 0}, {0, 1, 0}}}};  // -Z

// Where the faces +X -X +Y -Y +Z -Z lie, in faces from the left and from the top.
struct Layout {
  int columns, rows;
  std::array<std::array<int, 2>, 6> places;
};

Layout layout_named(const std::string& name) {
  if (name == "column") return {1, 6, {{{0, 0}, {0, 1}, {0, 2}, {0, 3}, {0, 4}, {0, 5}}}};
  if (name == "row") return {6, 1, {{{0, 0}, {1, 0}, {2, 0}, {3, 0}, {4, 0}, {5, 0}}}};
  if (name == "cross") return {4, 3, {{{2, 1}, {0, 1}, {1, 0}, {1, 2}, {3, 1}, {1, 1}}}};
  if (name == "vcross") return {3, 4, {{{2, 1}, {0, 1}, {1, 0}, {1, 2}, {1, 3}, {1, 1}}}};
  if (name == "3x2") return {3, 2, {{{0, 0}, {1, 0}, {2, 0}, {0, 1}, {1, 1}, {2, 1}}}};
  throw std::invalid_argument(name);
}

// With its first column and row at (x,y); `turned` by half a turn.
void draw_face(Picture& picture, int face, int x, int y, int size, bool turned) {
  const Axes& a = axes.at(std::size_t(face));
  const double sign = turned ? -1 : 1;
  for (int j = 0; j < size; ++j)
    for (int i = 0; i < size; ++i) {
      const double s = sign * ((2 * i + 1.0) / size - 1), t = sign * (1 - (2 * j + 1.0) / size);
      Vec d;
      for (std::size_t k = 0; k < 3; ++k) d[k] = a.forward[k] + s * a.right[k] + t * a.up[k];
      std::ranges::copy(colour_of(d), picture.at(x + i, y + j));
    }
}

void save_pfm(const std::string& path, const Picture& picture) {
  static_assert(std::endian::native == std::endian::little, "the scale below says little-endian");
  std::ofstream file(path, std::ios::binary);
  file << "PF\n" << picture.width << ' ' << picture.height << "\n-1.0\n";
  const auto row_bytes = std::streamsize(sizeof(float)) * picture.width * picture.channels;
  for (int y = picture.height - 1; y >= 0; --y) file.write(reinterpret_cast<const char*>(picture.at(0, y)), row_bytes);
}

}  // namespace

Picture Picture::filled(int width, int height, float fill, int channels) {
  const auto count = std::size_t(width) * std::size_t(height) * std::size_t(channels);
  return {width, height, channels, std::vector<float>(count, fill)};
}

void save(const std::string& path, const Picture& picture, OIIO::TypeDesc type, OIIO::ImageSpec spec) {
  if (path.ends_with(".pfm")) return save_pfm(path, picture);
  spec.width = spec.full_width = picture.width;
  spec.height = spec.full_height = picture.height;
  spec.depth = spec.full_depth = 1;
  spec.nchannels = picture.channels;
  if (spec.channelnames.empty()) spec.default_channel_names();
  spec.format = type;
  const auto output = OIIO::ImageOutput::create(path);
  if (!output || !output->open(path, spec) || !output->write_image(OIIO::TypeDesc::FLOAT, picture.values.data()) ||
      !output->close())
    throw std::runtime_error(path + ": the test cannot write it");
}

Picture load(const std::string& path) {
  OIIO::ImageSpec config;
  // Without settings OpenImageIO 2.5 takes the first row of a PFM file for the top.
  config.attribute("pnm:pfmflip", 1);
  const auto input = OIIO::ImageInput::open(path, &config);
  if (!input) throw std::runtime_error(path + ": the test cannot read it: " + OIIO::geterror());
  Picture picture = Picture::filled(input->spec().width, input->spec().height, 0, input->spec().nchannels);
  if (!input->read_image(0, 0, 0, picture.channels, OIIO::TypeDesc::FLOAT, picture.values.data()))
    throw std::runtime_error(path + ": the test cannot read it: " + input->geterror());
  return picture;
}

double difference(const Picture& a, const Picture& b) {
  if (a.width != b.width || a.height != b.height || a.channels != b.channels)
    return std::numeric_limits<double>::infinity();
  double largest = 0;
  for (std::size_t k = 0; k < a.values.size(); ++k) {
    const double d = std::abs(double{a.values[k]} - double{b.values[k]});
    if (!(d <= largest)) largest = d;  // NaN, too.
  }
  return largest;
}

std::array<float, 3> colour_of(const Vec& d) {
  const double length = std::hypot(d[0], d[1], d[2]);
  std::array<float, 3> colour;
  for (std::size_t k = 0; k < 3; ++k) colour[k] = float(0.5 * (d[k] / length + 1));
  return colour;
}

Picture latlong_directions(int height, bool border) {
  Picture picture = Picture::filled(2 * height, height);
  for (int j = 0; j < picture.height; ++j)
    for (int i = 0; i < picture.width; ++i) {
      const double u = border ? i / (picture.width - 1.0) : (i + 0.5) / picture.width;
      const double v = border ? j / (picture.height - 1.0) : (j + 0.5) / picture.height;
      const double longitude = (0.5 - u) * 2 * pi, latitude = (0.5 - v) * pi;
      std::ranges::copy(colour_of({std::cos(latitude) * std::sin(longitude), std::sin(latitude),
                                   std::cos(latitude) * std::cos(longitude)}),
                        picture.at(i, j));
    }
  return picture;
}

Picture cube_directions(const std::string& layout, int size) {
  const Layout l = layout_named(layout);
  Picture picture = Picture::filled(l.columns * size, l.rows * size);
  for (int face = 0; face < 6; ++face) {
    const auto [column, row] = l.places.at(std::size_t(face));
    draw_face(picture, face, column * size, row * size, size, layout == "vcross" && face == 4);
  }
  return picture;
}

Picture face_directions(int face, int size) {
  Picture picture = Picture::filled(size, size);
  draw_face(picture, face, 0, 0, size, false);
  return picture;
}

}  // namespace command_tests
