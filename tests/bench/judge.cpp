// How far a tool's result is from the truth, for tests/bench/commands.py.
//
//   judge RESULT PROJECTION SAMPLES SOURCE PROJECTION SAMPLES
//
// The truth of a texel is the solid-angle mean of the source's bilinear reconstruction over the texel, in double, by 8
// midpoints each way, more where the texel spans several of the source. SAMPLES says where a tool takes its samples to
// lie, in what it reads as in what it writes: `centre` of the texels; `border`, OpenEXR's convention (the first and
// last on the edges of the image); `corner`, sample i at i/W. Every tool is judged at its own samples, so no result is
// resampled. envmap's filters have no part in this beyond the apron, only its projections, which have their own tests.
#include <OpenImageIO/imageio.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "envmap/base/parallel.h"
#include "envmap/map/atlas.h"
#include "envmap/map/layout.h"
#include "envmap/projection/visit.h"
#include "envmap/sample/padded_level.h"

namespace {

using namespace envmap;

// Sample i of W lies at u = (i + offset) / (W - less).
struct Samples {
  double offset, less;
};

Samples samples_named(std::string_view name) {
  if (name == "centre") return {0.5, 0};
  if (name == "border") return {0, 1};
  if (name == "corner") return {0, 0};
  throw std::runtime_error(fmt::format("{}: centre, border or corner", name));
}

struct Picture {
  Level level;
  Samples samples;
  std::optional<PaddedLevel> padded = {};  // Of samples at the centres of cells.
};

Picture read(const std::string& path, const std::string& projection, std::string_view samples) {
  const auto p = projection_named(projection);
  const auto input = OIIO::ImageInput::open(path);
  if (!p || !input) throw std::runtime_error(fmt::format("{} ({}): {}", path, projection, OIIO::geterror()));
  const OIIO::ImageSpec& spec = input->spec();
  const Grid faces_in = grid(default_layout(*p));
  Picture picture{Level(*p, spec.height / faces_in.rows), samples_named(samples)};
  const Level& level = picture.level;
  if (spec.nchannels < 3 || spec.width != level.width() * faces_in.columns ||
      spec.height != level.height() * faces_in.rows)
    throw std::runtime_error(fmt::format("{}: {}x{} is no {} map", path, spec.width, spec.height, projection));
  std::vector<Colour> pixels(std::size_t(spec.width) * std::size_t(spec.height));
  if (!input->read_image(0, 0, 0, 3, OIIO::TypeDesc::FLOAT, pixels.data()))
    throw std::runtime_error(fmt::format("{}: {}", path, input->geterror()));
  scatter(pixels, spec.width, 0, spec.height, faces_in, picture.level);
  return picture;
}

Direction bilinear(const Picture& from, const Location<double>& at) {
  const Level& level = from.level;
  const double x = at.u * (level.width() - from.samples.less) - from.samples.offset;
  const double y = at.v * (level.height() - from.samples.less) - from.samples.offset;
  // Border samples have nothing beyond them; the others read the apron there.
  const int past = from.samples.less > 0 ? 2 : 1;
  const int i = std::min(int(std::floor(x)), level.width() - past);
  const int j = std::min(int(std::floor(y)), level.height() - past);
  const auto texel = [&](int column, int row) {
    return Direction(*(from.padded ? from.padded->texel(at.face, column, row) : level.texel(at.face, column, row)));
  };
  const Direction a = texel(i, j), b = texel(i + 1, j), c = texel(i, j + 1), d = texel(i + 1, j + 1);
  return glm::mix(glm::mix(a, b, x - i), glm::mix(c, d, x - i), y - j);
}

struct Mean {
  Direction value{0};
  double weight = 0;  // Steradians; 0 outside the disc.
};

// One texel by steps x steps points. Those of border samples reach over the edge, where the projection goes on.
Mean truth(const Picture& source, const Picture& result, int face, int i, int j, int steps) {
  static thread_local std::vector<Point2> points;
  static thread_local std::vector<Direction> towards;
  static thread_local std::vector<double> density;
  static thread_local std::vector<Location<double>> where;
  const auto count = std::size_t(steps);
  points.resize(count), towards.resize(count), density.resize(count), where.resize(count);
  const Level& level = result.level;
  const double across = level.width() - result.samples.less, down = level.height() - result.samples.less;
  Mean mean;
  for (int y = 0; y < steps; ++y) {
    const double v = (j + result.samples.offset + (y + 0.5) / steps - 0.5) / down;
    for (int x = 0; x < steps; ++x)
      points[std::size_t(x)] = {(i + result.samples.offset + (x + 0.5) / steps - 0.5) / across, v};
    densities(level.projection(), points, density);
    directions(level.projection(), face, points, towards);
    locate(source.level.projection(), towards, where);
    for (std::size_t k = 0; k < count; ++k) {
      const double w = std::abs(density[k]) / (across * down * steps * steps);  // Latlong: negative over the pole.
      mean.value += w * bilinear(source, where[k]);
      mean.weight += w;
    }
  }
  if (mean.weight > 0) mean.value /= mean.weight;
  return mean;
}

int steps_for(const Picture& source, const Picture& result) {
  const auto pitch = [](const Level& level) {
    return visit(level.projection(), [](auto p) { return decltype(p)::span; }) / level.height();
  };
  return std::max(8, int(std::ceil(8 * pitch(result.level) / pitch(source.level))));
}

// The measures of envmap-accuracy(7); rows are summed in order, so that threads change nothing.
void judge(const Picture& source, const Picture& result) {
  struct Sums {
    double weight = 0, error = 0, truth = 0;
    Direction flux{0};
  };
  const Level& level = result.level;
  const int steps = steps_for(source, result);
  Level truths(level.projection(), level.height());
  std::vector<Sums> rows(std::size_t(level.faces() * level.height()));
  for_each_row(level.faces(), level.height(), {}, [&](int face, int row) {
    Sums& s = rows[std::size_t(face * level.height() + row)];
    for (int i = 0; i < level.width(); ++i) {
      const Mean t = truth(source, result, face, i, row, steps);
      const Direction off = Direction(*level.texel(face, i, row)) - t.value;
      *truths.texel(face, i, row) = t.weight > 0 ? Colour(t.value) : Colour(-1);
      s.weight += t.weight, s.flux += t.weight * t.value;
      s.error += t.weight * glm::dot(off, off), s.truth += t.weight * glm::dot(t.value, t.value);
    }
  });
  Sums all;
  for (const Sums& s : rows) all.weight += s.weight, all.flux += s.flux, all.error += s.error, all.truth += s.truth;

  double largest = 0;
  const double floor = 1e-3 * (all.flux.x + all.flux.y + all.flux.z) / (3 * all.weight);
  for (int face = 0; face < level.faces(); ++face)
    for (int j = 0; j < level.height(); ++j)
      for (int i = 0; i < level.width(); ++i)
        for (int c = 0; c < 3 && truths.texel(face, i, j)->x >= 0; ++c) {
          const double t = (*truths.texel(face, i, j))[c];
          largest = std::max(largest, std::abs((*level.texel(face, i, j))[c] - t) / std::max(t, floor));
        }
  fmt::print("{{\"rms\": {:.4e}, \"max\": {:.4e}}}\n", std::sqrt(all.error / all.truth), largest);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 7) {
    fmt::print(stderr, "usage: judge RESULT PROJECTION SAMPLES SOURCE PROJECTION SAMPLES\n");
    return 2;
  }
  try {
    const Picture result = read(argv[1], argv[2], argv[3]);
    Picture source = read(argv[4], argv[5], argv[6]);
    if (source.samples.less == 0) source.padded.emplace(source.level);
    judge(source, result);
  } catch (const std::exception& e) {
    fmt::print(stderr, "judge: {}\n", e.what());
    return 1;
  }
  return 0;
}
