// What files state of their colours and range, without the files around it.
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <string>
#include <vector>

#include "envmap/base/error.h"
#include "envmap/io/claims/gain_map.h"
#include "envmap/io/claims/icc_profile.h"
#include "envmap/io/claims/xmp.h"
#include "targets.h"

using namespace envmap;

namespace {

template <class Action>
void expect_error_or_nothing(const Action& action) {
  try {
    action();
  } catch (const InputError& e) {
    std::string words = e.what();  // Image::fail() makes what is quoted printable.
    if (words.find('\n') != words.npos) std::abort();
  }
}

void apply(const IccColours& icc) {
  std::vector<Colour> colours{Colour(0), Colour(0.25F), Colour(1), Colour(0.1F, 0.5F, 0.9F), Colour(-1)};
  if (icc.colour.decode) icc.colour.decode(colours);
  const std::vector<float> inks(4 * colours.size(), 0.5F);
  if (icc.from_inks) icc.from_inks(inks, colours);
}

void apply(GainMap map) {
  map.width = 2, map.height = 1, map.channels = 1, map.values = {0, 255};
  std::vector<Colour> row{Colour(0), Colour(1), Colour(0.5F)};
  apply_gain(map, map.weight(3.0), 0, 1, row);
  for (const Colour& c : row)
    if (!(c.x >= 0) || !std::isfinite(c.x)) std::abort();
}

}  // namespace

void fuzz_icc(Bytes bytes) {
  expect_error_or_nothing([&] { apply(read_icc(bytes)); });
}

void fuzz_gain(Bytes bytes) {
  const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  expect_error_or_nothing([&] {
    if (const auto map = gain_map_of_xmp(parse_xmp(text))) apply(*map);
  });
  expect_error_or_nothing([&] {
    if (const auto map = gain_map_of_iso({reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size()}))
      apply(*map);
  });
}
