// Rows of the table of claims: colour and range.
#include "claims.h"

namespace command_tests {
namespace {

// 128/256 2^(129-128), 64/256 2 and 32/256 2 (Ward 1991).
constexpr std::array<int, 4> half_quarter_eighth{64, 32, 16, 129};

// ITU-R BT.2087-0, section 4: the inverse of its matrix M2, rounded to six places.
std::array<double, 3> of_rec2020(const std::array<double, 3>& c) {
  constexpr double rows[3][3] = {{1.660491, -0.587641, -0.072850},
                                 {-0.124550, 1.132900, -0.008349},
                                 {-0.018151, -0.100579, 1.118730}};
  std::array<double, 3> out = {};
  for (std::size_t k = 0; k < 3; ++k)
    for (std::size_t j = 0; j < 3; ++j) out[k] += rows[k][j] * c[j];
  return out;
}

void add_radiance(std::vector<ClaimRow>& rows) {
  const auto add = [&](const std::string& claim, Becomes becomes, const std::string& name, const std::string& header,
                       const std::array<double, 3>& value, const std::vector<std::string>& words = {}) {
    rows.push_back({"HDR", claim, becomes, name, radiance(header, 2, 1, half_quarter_eighth), value, words});
  };
  add("EXPOSURE", Becomes::honoured, "exposure.hdr", "EXPOSURE=2\nEXPOSURE=2\n", {0.125, 0.0625, 0.03125}, {"4"});
  add("EXPOSURE", Becomes::ignored, "none.hdr", "GAMMA=1\nEXPOSURE=0\nFORMAT=32-bit_rle_rgbe\n", {0.5, 0.25, 0.125});
  add("EXPOSURE", Becomes::refused, "word.hdr", "EXPOSURE=many\n", {}, {"damaged", "EXPOSURE"});
  add("GAMMA", Becomes::honoured, "gamma.hdr", "GAMMA=2\n", {0.25, 0.0625, 0.015625});
  // Values of CIE XYZ are luminous: 179 lumens a watt. Of X = Y = Z the light is that of equal energy, in these
  // primaries, whose white it is: all are alike.
  rows.push_back({"HDR",
                  "FORMAT",
                  Becomes::honoured,
                  "xyze.hdr",
                  radiance("FORMAT=32-bit_rle_xyze\nPRIMARIES=.64 .33 .3 .6 .15 .06 .3333333333 .3333333333\n", 2, 1,
                           {128, 128, 128, 136}),
                  {128 / 179.0, 128 / 179.0, 128 / 179.0}});
  add("PRIMARIES", Becomes::honoured, "wide.hdr", "PRIMARIES=.708 .292 .17 .797 .131 .046 .3127 .329\n",
      of_rec2020({0.5, 0.25, 0.125}));
  add("PRIMARIES", Becomes::ignored, "zeros.hdr", "PRIMARIES=0 0 0 0 0 0 0 0\n", {0.5, 0.25, 0.125});
  add("COLORCORR", Becomes::honoured, "colorcorr.hdr", "COLORCORR=2 1 .5\n", {0.25, 0.25, 0.25});
}

}  // namespace

std::vector<ClaimRow> claims_of_colour() {
  std::vector<ClaimRow> rows;
  add_radiance(rows);
  return rows;
}

}  // namespace command_tests
