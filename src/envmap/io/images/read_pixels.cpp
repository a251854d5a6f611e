#include "envmap/io/images/read_pixels.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <optional>
#include <vector>

#include "envmap/base/error.h"
#include "envmap/base/words.h"
#include "envmap/io/claims/srgb.h"
#include "envmap/map/atlas.h"

namespace envmap {
namespace {

// First channel of the R, G, B to read, and how many: 3, or 1 for grey.
struct Channels {
  int first, count;
};

bool is(const std::string& channel, char wanted) {
  return channel.size() == 1 && std::toupper(static_cast<unsigned char>(channel[0])) == wanted;
}

Channels choose_channels(const Image& image, const ReadOptions& options) {
  const ImageFacts& facts = image.reader->facts;
  const std::vector<std::string>& names = facts.channels;
  if (facts.chosen > 0) return {0, facts.chosen};
  int first = -1, count = 3;
  for (std::size_t c = 0; c + 2 < names.size() && first < 0; ++c)
    if (is(names[c], 'R') && is(names[c + 1], 'G') && is(names[c + 2], 'B')) first = int(c);
  if (first < 0 && names.size() >= 3 && !facts.names) first = 0;
  if (names.size() == 1 && (is(names[0], 'Z') || is(names[0], 'A')))
    image.fail(fmt::format("holds only {} ({}), no radiance", names[0], is(names[0], 'Z') ? "depth" : "alpha"));
  if (first < 0 && (names.size() == 1 || (names.size() == 2 && is(names[1], 'A')))) first = 0, count = 1;
  if (first < 0) image.fail(fmt::format("no R, G and B among its {} channels ({})", names.size(), some_of(names)));
  if (std::ssize(names) == count || options.drop_channels) return {first, count};
  std::vector<std::string> others = names;
  others.erase(others.begin() + first, others.begin() + first + count);
  image.fail(fmt::format("has channels besides R, G and B ({})", some_of(others)), Remedy::drop_channels);
}

// Rows [begin, end) of a level as RGB. @param alpha of the rows, where colours are not multiplied by it.
void read_band(const Image& image, int level, const Channels& channels, int begin, int end, std::span<Colour> out,
               std::vector<float>& alpha) {
  // Grey values come into the last third, and are spread from the first on.
  const std::size_t values = out.size() * std::size_t(channels.count);
  const std::span<float> last = std::span(&out.data()->x, 3 * out.size()).last(values);
  if (image.reader->facts.straight_alpha) {
    const std::size_t all = std::size_t(channels.count) + 1;
    std::vector<float> samples(out.size() * all);
    image.read(level, begin, end, channels.first, channels.count + 1, samples);
    alpha.resize(out.size());
    for (std::size_t k = 0; k < out.size(); ++k) {
      std::copy_n(samples.begin() + std::ptrdiff_t(k * all), channels.count,
                  last.begin() + std::ptrdiff_t(k * (all - 1)));
      alpha[k] = samples[k * all + all - 1];
    }
  } else {
    image.read(level, begin, end, channels.first, channels.count, last);
  }
  if (channels.count == 1)
    for (std::size_t k = 0; k < out.size(); ++k) out[k] = Colour(last[k]);
}

// Stored values -> linear light. Colours are multiplied by alpha as light.
void decode(const Image& image, std::span<Colour> rows, const std::vector<float>& alpha) {
  const ImageFacts& facts = image.reader->facts;
  if (image.decode && !facts.colour && facts.encoded) decode_srgb(rows);
  try {
    if (image.decode && facts.colour && facts.colour->decode) facts.colour->decode(rows);
  } catch (const InputError& e) {
    image.fail(e.what(), e.remedy());
  }
  for (std::size_t k = 0; k < alpha.size(); ++k) rows[k] *= alpha[k];
}

// The limit where the map would take more than half of it; else none.
std::size_t scratch(std::size_t max_memory, const ImageFacts& image) {
  const auto texels = std::size_t(image.width) * std::size_t(image.height);
  return texels * sizeof(Colour) > max_memory / 2 ? max_memory : 0;
}

}  // namespace

FaceSize face_in(const Image& image, int stored, const DetectedLayout& base, int number) {
  const ImageFacts facts = image.reader->level_facts(stored).value_or(image.reader->facts);
  FaceSize face = face_size(base, number);
  const Grid places = grid(base.layout);
  // A latlong image is all of the sphere, also where its writer rounded up.
  const auto rounded_up = [](int is, int wanted) { return is == wanted || is == wanted + 1; };
  if (base.projection == Projection::latlong && rounded_up(facts.width, face.width) &&
      rounded_up(facts.height, face.height))
    face = {facts.width, facts.height};
  if (facts.width < places.columns * face.width || facts.height < places.rows * face.height)
    image.fail(fmt::format("level {} is {}x{}, too small for faces of {}x{}", number, facts.width, facts.height,
                           face.width, face.height));
  return face;
}

Level read_pixels(const Image& image, const ReadOptions& options, int stored, const DetectedLayout& base,
                  const FaceSize& face, const Progress& progress) {
  const Channels channels = choose_channels(image, options);
  const ImageFacts facts = image.reader->level_facts(stored).value_or(image.reader->facts);
  const Grid places = grid(base.layout);
  // Whole rows of tiles; enough lines that every core decompresses.
  const int unit = facts.tile_width > 0 ? facts.tile_height : 16;
  const int band_rows = (std::max(128, unit) / unit) * unit;
  std::vector<Colour> band(std::size_t(std::min(band_rows, facts.height)) * std::size_t(facts.width));
  std::optional<Level> level;
  for (int begin = 0; begin < facts.height; begin += band_rows) {
    const int end = std::min(begin + band_rows, facts.height);
    const auto rows = std::span(band).first(std::size_t(end - begin) * std::size_t(facts.width));
    std::vector<float> alpha;
    read_band(image, stored, channels, begin, end, rows, alpha);
    decode(image, rows, alpha);
    if (!level) level.emplace(base.projection, face.height, face.width, scratch(options.max_memory, facts));
    scatter(rows, facts.width, begin, end, places, *level);
    level->trim();
    if (progress) progress(double(end) / facts.height);
  }
  return std::move(*level);
}

}  // namespace envmap
