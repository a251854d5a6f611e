// Rows of the table of claims: colour and range.
#include <cmath>

#include "claims.h"

namespace command_tests {
namespace {

using Triple = std::array<double, 3>;
using Rows = std::vector<ClaimRow>;

Triple times(const double (&rows)[3][3], const Triple& c) {
  Triple out = {};
  for (std::size_t k = 0; k < 3; ++k)
    for (std::size_t j = 0; j < 3; ++j) out[k] += rows[k][j] * c[j];
  return out;
}

Triple each(const Triple& c, double (*f)(double)) { return {f(c[0]), f(c[1]), f(c[2])}; }

// IEC 61966-2-1.
double srgb(double v) { return v <= 0.04045 ? v / 12.92 : std::pow((v + 0.055) / 1.055, 2.4); }

// ITU-R BT.2087-0, section 4: the inverse of its matrix M2, rounded to six places.
Triple of_rec2020(const Triple& c) {
  return times({{1.660491, -0.587641, -0.072850}, {-0.124550, 1.132900, -0.008349}, {-0.018151, -0.100579, 1.118730}},
               c);
}

// SMPTE EG 432-1 and BT.709, by RP 177.
Triple of_p3(const Triple& c) {
  return times({{1.2249401763, -0.2249401763, 0},
                {-0.0420569547, 1.0420569547, 0},
                {-0.0196375546, -0.0786360456, 1.0982736001}},
               c);
}

// CIE XYZ under D50 (Bradford) -> linear Rec.709: Lindbloom, "RGB/XYZ matrices".
Triple of_d50(const Triple& xyz) {
  return times({{3.1338561, -1.6168667, -0.4906146},
                {-0.9787684, 1.9161415, 0.0334540},
                {0.0719453, -0.2289914, 1.4052427}},
               xyz);
}

// ---- Radiance -------------------------------------------------------------------------------------------------------

// 64/256 2^(129-128), 32/256 2 and 16/256 2 (Ward 1991).
constexpr std::array<int, 4> half_quarter_eighth{64, 32, 16, 129};

void add_radiance(Rows& rows) {
  const auto add = [&](const std::string& claim, Becomes becomes, const std::string& name, const std::string& header,
                       const Triple& value, const std::vector<std::string>& words = {}) {
    rows.push_back({"HDR", claim, becomes, name, radiance(header, 2, 1, half_quarter_eighth), value, words});
  };
  add("EXPOSURE", Becomes::honoured, "exposure.hdr", "EXPOSURE=2\nEXPOSURE=2\n", {0.125, 0.0625, 0.03125}, {"2"});
  add("EXPOSURE", Becomes::ignored, "none.hdr", "GAMMA=1\nEXPOSURE=0\nFORMAT=32-bit_rle_rgbe\n", {0.5, 0.25, 0.125});
  add("EXPOSURE", Becomes::refused, "word.hdr", "EXPOSURE=many\n", {}, {"damaged", "EXPOSURE"});
  add("GAMMA", Becomes::honoured, "gamma.hdr", "GAMMA=2\n", {0.25, 0.0625, 0.015625});
  add("COLORCORR", Becomes::honoured, "colorcorr.hdr", "COLORCORR=2 1 .5\n", {0.25, 0.25, 0.25});
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
}

// ---- ICC profiles ---------------------------------------------------------------------------------------------------

// Lindbloom, "RGB/XYZ matrices", under D50: columns are colorants.
constexpr Triple srgb_colorants[] = {{0.4360747, 0.2225045, 0.0139322},
                                     {0.3850649, 0.7168786, 0.0971045},
                                     {0.1430804, 0.0606169, 0.7141733}};
constexpr Triple prophoto_colorants[] = {{0.7976749, 0.2880402, 0},
                                         {0.1351917, 0.7118741, 0},
                                         {0.0313534, 0.0000857, 0.8252100}};
// Of Display P3 as its profiles have it.
constexpr Triple p3_colorants[] = {{0.515102, 0.241182, -0.00105},
                                   {0.291965, 0.692236, 0.041882},
                                   {0.157153, 0.066582, 0.784378}};

const std::string linear_curve = "curv" + big(0, 4) + big(0, 4);
const std::string srgb_curve = "para" + big(0, 4) + big(3 << 16, 4) + fixed(2.4) + fixed(1 / 1.055) +
                               fixed(0.055 / 1.055) + fixed(1 / 12.92) + fixed(0.04045);
const std::string gamma_curve = "curv" + big(0, 4) + big(1, 4) + big(256 * 18 / 10, 2);  // 460/256.
const std::string table_curve = "curv" + big(0, 4) + big(3, 4) + big(0, 2) + big(65535 / 4, 2) + big(65535, 2);

std::string matrix_profile(const std::string& name, const Triple (&colorants)[3], const std::string& curve) {
  return icc("RGB ", name,
             {{"rXYZ", icc_xyz(colorants[0])},
              {"gXYZ", icc_xyz(colorants[1])},
              {"bXYZ", icc_xyz(colorants[2])},
              {"rTRC", curve},
              {"gTRC", curve},
              {"bTRC", curve}});
}

// A look-up table of 16 bits and two points a side (ICC.1, section 10.10), whose first channel varies least rapidly.
// @param xyz of each corner.
std::string table_profile(const std::string& space, const std::string& name, const std::vector<Triple>& corners) {
  const int channels = space == "CMYK" ? 4 : 3;
  std::string lut = "mft2" + big(0, 4) + big(std::uint64_t(channels), 1) + std::string("\3\2\0", 3);
  for (int k = 0; k < 9; ++k) lut += fixed(k % 4 == 0 ? 1 : 0);
  lut += big(2, 2) + big(2, 2);
  for (int c = 0; c < channels; ++c) lut += big(0, 2) + big(65535, 2);
  for (const Triple& xyz : corners)
    for (const double v : xyz) lut += big(std::uint64_t(std::lround(v * 32768)), 2);
  for (int c = 0; c < 3; ++c) lut += big(0, 2) + big(65535, 2);
  return icc(space, name, {{"A2B0", lut}, {"A2B1", lut}});
}

std::vector<Triple> corners_of(const Triple (&colorants)[3]) {
  std::vector<Triple> corners;
  for (int k = 0; k < 8; ++k) {
    Triple sum = {};
    for (std::size_t c = 0; c < 3; ++c)
      for (std::size_t j = 0; j < 3; ++j) sum[j] += (k >> (2 - int(c)) & 1) * colorants[c][j];
    corners.push_back(sum);
  }
  return corners;
}

// Magenta alone is one corner of the table. Its colour is .5 .25 .125 in linear Rec.709.
std::string ink_profile() {
  std::vector<Triple> corners(16, Triple{0.9642, 1, 0.8249});
  for (std::size_t j = 0; j < 3; ++j)
    corners[4][j] = 0.5 * srgb_colorants[0][j] + 0.25 * srgb_colorants[1][j] + 0.125 * srgb_colorants[2][j];
  return table_profile("CMYK", "Inks", corners);
}

std::string iccp(const std::string& profile) {
  return png_chunk("iCCP", std::string("a name\0\0", 8) + stored_zlib(profile));
}

constexpr std::array<unsigned, 3> stored{32768, 16384, 6554};
const Triple values{32768 / 65535.0, 16384 / 65535.0, 6554 / 65535.0};

void add_profiles(Rows& rows) {
  const auto add = [&](const std::string& name, const std::string& profile, const Triple& value,
                       const std::string& said, double tolerance = 2e-4) {
    rows.push_back({"PNG",
                    "ICC profile",
                    Becomes::honoured,
                    name,
                    png(2, 1, 16, stored, iccp(profile)),
                    value,
                    {said},
                    tolerance});
  };
  add("linear.png", matrix_profile("Linear sRGB", srgb_colorants, linear_curve), values, "Linear sRGB");
  add("p3.png", matrix_profile("Display P3", p3_colorants, srgb_curve), of_p3(each(values, srgb)), "Display P3");
  const Triple powers = each(values, [](double v) { return std::pow(v, 460 / 256.0); });
  add("prophoto.png", matrix_profile("Wide", prophoto_colorants, gamma_curve),
      of_d50(times({{0.7976749, 0.1351917, 0.0313534}, {0.2880402, 0.7118741, 0.0000857}, {0, 0, 0.8252100}}, powers)),
      "Wide", 2e-3);
  // Between the points of the table .5 is its second, .25 and .1 are on the way there.
  add("table.png", matrix_profile("Table", srgb_colorants, table_curve), {0.25, 0.125, 0.05}, "Table", 1e-3);
  add("look-up.png", table_profile("RGB ", "Look-up", corners_of(srgb_colorants)), values, "Look-up", 1e-3);
  const auto refuse = [&](const std::string& format, const std::string& name, const std::string& bytes,
                          const std::vector<std::string>& words) {
    rows.push_back({format, "ICC profile", Becomes::refused, name, bytes, {}, words});
  };
  const std::string whole = matrix_profile("Broken", srgb_colorants, linear_curve);
  refuse("PNG", "cut.png", png(2, 1, 16, stored, iccp(whole.substr(0, 200))),
         {"ICC profile", "damaged", "--input-space"});
  refuse("PNG", "no-curve.png",
         png(2, 1, 16, stored,
             iccp(icc("RGB ", "No curve",
                      {{"rXYZ", icc_xyz(srgb_colorants[0])},
                       {"gXYZ", icc_xyz(srgb_colorants[1])},
                       {"bXYZ", icc_xyz(srgb_colorants[2])}}))),
         {"ICC profile 'No curve'", "rTRC"});
  refuse("PNG", "packed.png", png(2, 1, 16, stored, png_chunk("iCCP", std::string("a\0\0no zlib", 10))),
         {"iCCP", "damaged"});
  refuse("PNG", "grey.png", png(2, 1, 16, stored, iccp(icc("GRAY", "Grey", {{"kTRC", linear_curve}}))),
         {"ICC profile 'Grey'"});
  refuse("PNG", "lab.png", png(2, 1, 16, stored, iccp(icc("Lab ", "Lab", {{"kTRC", linear_curve}}))),
         {"ICC profile 'Lab'", "not supported"});
}

// ---- PNG ------------------------------------------------------------------------------------------------------------

// ITU-R BT.2100-2, table 4.
double pq(double v) {
  const double p = std::pow(v, 1 / 78.84375);
  return 10000 / 203.0 * std::pow(std::max(p - 0.8359375, 0.0) / (18.8515625 - 18.6875 * p), 1 / 0.1593017578125);
}

// Table 5, of grey, on a display of 1000 cd/m^2.
double hlg(double v) {
  const double scene = v <= 0.5 ? v * v / 3 : (std::exp((v - 0.55991073) / 0.17883277) + 0.28466892) / 12;
  return 1000 / 203.0 * std::pow(scene, 1.2);
}

std::string cicp(unsigned primaries, unsigned transfer, unsigned matrix = 0, unsigned full = 1) {
  return png_chunk("cICP", big(primaries, 1) + big(transfer, 1) + big(matrix, 1) + big(full, 1));
}

std::string chrm(const std::vector<double>& xy) {
  std::string data;
  for (const double v : xy) data += big(std::uint64_t(std::lround(v * 100000)), 4);
  return png_chunk("cHRM", data);
}

void add_png(Rows& rows) {
  const auto add = [&](const std::string& claim, Becomes becomes, const std::string& name, const std::string& chunks,
                       const Triple& value, const std::vector<std::string>& words = {},
                       const std::array<unsigned, 3>& colour = stored) {
    rows.push_back({"PNG", claim, becomes, name, png(2, 1, 16, colour, chunks), value, words});
  };
  const std::string gamma_one = png_chunk("gAMA", big(100000, 4)), srgb_chunk = png_chunk("sRGB", std::string(1, '\0'));
  const std::string wide = chrm({0.3127, 0.329, 0.708, 0.292, 0.17, 0.797, 0.131, 0.046});
  constexpr std::array<unsigned, 3> bright{49271, 45000, 41000}, grey{49151, 49151, 49151};
  const Triple of_bright{49271 / 65535.0, 45000 / 65535.0, 41000 / 65535.0};
  add("cICP", Becomes::honoured, "pq.png", cicp(9, 16), of_rec2020(each(of_bright, pq)), {"PQ", "BT.2020"}, bright);
  add("cICP", Becomes::honoured, "hlg.png", cicp(9, 18),
      {hlg(49151 / 65535.0), hlg(49151 / 65535.0), hlg(49151 / 65535.0)}, {"HLG"}, grey);
  add("cICP", Becomes::honoured, "p3-cicp.png", cicp(12, 13), of_p3(each(values, srgb)), {"Display P3"});
  add("cICP", Becomes::honoured, "narrow.png", cicp(1, 8, 0, 0),
      {(32768 - 4096) / 56064.0, (16384 - 4096) / 56064.0, (6554 - 4096) / 56064.0}, {"narrow"});
  add("cICP", Becomes::ignored, "unspecified.png", cicp(2, 2) + gamma_one, values);
  add("cICP", Becomes::honoured, "first.png",
      gamma_one + cicp(12, 13) + iccp(matrix_profile("Linear", srgb_colorants, linear_curve)),
      of_p3(each(values, srgb)));
  add("iCCP", Becomes::ignored, "second.png",
      cicp(12, 13) + iccp(matrix_profile("Linear", srgb_colorants, linear_curve)), of_p3(each(values, srgb)));
  add("sRGB", Becomes::ignored, "third.png", iccp(matrix_profile("Linear", srgb_colorants, linear_curve)) + srgb_chunk,
      values);
  add("gAMA", Becomes::ignored, "fourth.png", gamma_one + srgb_chunk, each(values, srgb));
  add("cICP", Becomes::refused, "log.png", cicp(9, 9), {}, {"cICP", "transfer 9", "not supported"});
  add("cICP", Becomes::refused, "odd.png", cicp(3, 13), {}, {"cICP", "primaries 3", "not supported"});
  add("cICP", Becomes::refused, "ycc.png", cicp(9, 16, 9), {}, {"cICP", "matrix"});
  add("cICP", Becomes::refused, "short.png", png_chunk("cICP", "\1\15"), {}, {"damaged", "cICP"});
  add("sRGB", Becomes::honoured, "srgb.png", srgb_chunk, each(values, srgb));
  add("gAMA", Becomes::honoured, "one.png", gamma_one, values);
  add("gAMA", Becomes::honoured, "gamma.png", png_chunk("gAMA", big(50000, 4)),
      each(values, [](double v) { return v * v; }));
  add("gAMA", Becomes::ignored, "no-gamma.png", png_chunk("gAMA", big(0, 4)), each(values, srgb));
  add("cHRM", Becomes::honoured, "wide.png", gamma_one + wide, of_rec2020(values));
  add("cHRM", Becomes::honoured, "wide-srgb.png", wide, of_rec2020(each(values, srgb)));
  add("cHRM", Becomes::refused, "line.png", gamma_one + chrm({0.3, 0.3, 0.1, 0.1, 0.2, 0.2, 0.3, 0.3}), {},
      {"damaged", "cHRM"});
  std::string broken = gamma_one;
  broken.back() = static_cast<char>(broken.back() ^ 1);
  add("gAMA", Becomes::refused, "checksum.png", broken, {}, {"damaged", "gAMA"});
  add("mDCV", Becomes::ignored, "mastering.png", gamma_one + png_chunk("mDCV", std::string(24, '\1')), values);
  add("cLLI", Becomes::ignored, "light.png", gamma_one + png_chunk("cLLI", std::string(8, '\1')), values);
}

// ---- TIFF -----------------------------------------------------------------------------------------------------------

std::string floats(std::initializer_list<double> numbers) {
  std::string bytes;
  for (const double x : numbers) bytes += little_float(float(x));
  return bytes;
}

std::string rationals(std::initializer_list<double> numbers) {
  std::string bytes;
  for (const double x : numbers) bytes += little(std::uint64_t(std::lround(x * 1e6)), 4) + little(1000000, 4);
  return bytes;
}

std::string shorts(std::initializer_list<unsigned> numbers) {
  std::string bytes;
  for (const unsigned x : numbers) bytes += little(x, 2);
  return bytes;
}

const TiffTag floating{339, 3, 3, shorts({3, 3, 3})};

// LogLuv of 32 bits (Larson 1998): 15 bits of 256 (log2 Y + 64), and u' and v' in 410ths, byte plane by byte plane in
// literal runs.
std::string log_luv(double luminance, double u, double v) {
  const auto le = unsigned(256 * (std::log2(luminance) + 64));
  const std::array<unsigned, 4> planes{le >> 8, le & 255U, unsigned(410 * u), unsigned(410 * v)};
  std::string bytes;
  for (const unsigned plane : planes) bytes += big(2, 1) + big(plane, 1) + big(plane, 1);
  return bytes;
}

void add_tiff(Rows& rows) {
  const auto add = [&](const std::string& claim, Becomes becomes, const std::string& name, const std::string& bytes,
                       const Triple& value, const std::vector<std::string>& words = {}, double tolerance = 1e-4) {
    rows.push_back({"TIFF", claim, becomes, name, bytes, value, words, tolerance});
  };
  const std::string texels = floats({0.8, 0.4, 0.2, 0.8, 0.4, 0.2});
  const Triple is{0.8, 0.4, 0.2};
  const TiffTag white{318, 5, 2, rationals({0.3127, 0.329})},
      wide{319, 5, 6, rationals({0.708, 0.292, 0.17, 0.797, 0.131, 0.046})};
  add("PrimaryChromaticities", Becomes::honoured, "wide.tif", tiff(2, 1, 3, 32, texels, {floating, white, wide}),
      of_rec2020(is));
  add("WhitePoint", Becomes::honoured, "white.tif", tiff(2, 1, 3, 32, texels, {floating, white, wide}), of_rec2020(is));
  add("PrimaryChromaticities", Becomes::refused, "line.tif",
      tiff(2, 1, 3, 32, texels, {floating, {319, 5, 6, rationals({0.1, 0.1, 0.2, 0.2, 0.3, 0.3})}}), {},
      {"damaged", "PrimaryChromaticities"});
  const std::string profile = matrix_profile("Wide", prophoto_colorants, linear_curve);
  const Triple of_profile =
      of_d50(times({{0.7976749, 0.1351917, 0.0313534}, {0.2880402, 0.7118741, 0.0000857}, {0, 0, 0.8252100}}, is));
  const TiffTag icc_tag{34675, 7, profile.size(), profile};
  add("ICC profile", Becomes::honoured, "prophoto.tif", tiff(2, 1, 3, 32, texels, {floating, icc_tag}), of_profile,
      {"Wide"}, 3e-4);
  add("WhitePoint", Becomes::ignored, "both.tif", tiff(2, 1, 3, 32, texels, {floating, icc_tag, white}), of_profile, {},
      3e-4);
  // Squares of 8 bits.
  std::string squares;
  for (int c = 0; c < 3; ++c)
    for (unsigned k = 0; k < 256; ++k) squares += little(std::uint64_t(std::lround(65535.0 * k * k / 65025)), 2);
  const TiffTag transfer{301, 3, 768, squares};
  const auto square = [](double v) { return v * v / 65025; };
  add("TransferFunction", Becomes::honoured, "squares.tif", tiff(2, 1, 3, 8, "\xc8\x64\x32\xc8\x64\x32", {transfer}),
      {square(200), square(100), square(50)}, {}, 1e-3);
  const auto grey = [](double light) {
    return icc("GRAY", "Grey", {{"kTRC", light == 1 ? linear_curve : table_curve}});
  };
  add("ICC profile", Becomes::honoured, "grey.tif",
      tiff(2, 1, 1, 16, little(32768, 2) + little(32768, 2), {{34675, 7, grey(2).size(), grey(2)}}), {0.25, 0.25, 0.25},
      {"Grey"}, 1e-3);
  const std::string inks = ink_profile();
  const TiffTag separated{262, 3, 1, little(5, 2)};
  add("ICC profile", Becomes::honoured, "inks.tif",
      tiff(2, 1, 4, 8, std::string("\0\xff\0\0\0\xff\0\0", 8), {separated, {34675, 7, inks.size(), inks}}),
      {0.5, 0.25, 0.125}, {"Inks"}, 1e-3);
  add("PhotometricInterpretation", Becomes::refused, "lab.tif", tiff(2, 1, 3, 8, "abcabc", {{262, 3, 1, little(8, 2)}}),
      {}, {"not supported", "L*a*b*"});
  const auto refuse = [&](const std::string& claim, const std::string& name, const std::string& bytes,
                          const std::string& word) {
    add(claim, Becomes::refused, name, bytes, {}, {"not supported", word});
  };
  refuse("PhotometricInterpretation", "white16.tif", tiff(2, 1, 1, 16, "abcd", {{262, 3, 1, little(0, 2)}}),
         "MinIsWhite");
  refuse("PhotometricInterpretation", "unknown.tif", tiff(2, 1, 3, 8, "abcabc", {{262, 3, 1, little(77, 2)}}),
         "PhotometricInterpretation 77");
  refuse("PhotometricInterpretation", "inks5.tif", tiff(2, 1, 5, 8, "abcdeabcde", {separated}), "CMYK with 5");
  refuse("SampleFormat", "float24.tif", tiff(2, 1, 3, 24, std::string(18, 'a'), {floating}), "24 bits");
  refuse("NewSubfileType", "reduced.tif", tiff(2, 1, 3, 8, "abcabc", {{254, 4, 1, little(1, 4)}}), "NewSubfileType");
  add("SampleFormat", Becomes::refused, "signed.tif",
      tiff(2, 1, 3, 16, "abcdefghijkl", {{339, 3, 3, shorts({2, 2, 2})}}), {}, {"not supported", "SampleFormat"});
  add("TransferFunction", Becomes::refused, "half.tif",
      tiff(2, 1, 3, 16, "abcdefghijkl", {floating, {301, 3, 3 * 65536, std::string(std::size_t{6} * 65536, '\1')}}), {},
      {"not supported", "TransferFunction"});
  // D65 of BT.709: u' = .1978, v' = .4683; what the codes hold is off by half a 410th, 1% of blue.
  const TiffTag sgi{259, 3, 1, little(34676, 2)}, luv{262, 3, 1, little(32845, 2)};
  const std::vector<TiffTag> log_tags{sgi, luv, {339, 3, 3, shorts({2, 2, 2})}};
  add("PhotometricInterpretation", Becomes::honoured, "luv.tif",
      tiff(2, 1, 3, 16, log_luv(100, 0.1978, 0.4683), log_tags), {100, 100, 100}, {"LogLuv"}, 0.02);
  const std::string grey_planes = log_luv(100, 0, 0).substr(0, 6);
  add("PhotometricInterpretation", Becomes::honoured, "logl.tif",
      tiff(2, 1, 1, 16, grey_planes, {sgi, {262, 3, 1, little(32844, 2)}, {339, 3, 1, little(2, 2)}}), {100, 100, 100},
      {"LogL"}, 0.003);
}

// ---- BMP and TGA ----------------------------------------------------------------------------------------------------

// A BITMAPV5HEADER and two texels, blue first. @param numbers of the colour space: its end points and gammas.
std::string bmp(const std::string& kind, const std::string& numbers, const std::string& profile = {}) {
  const std::string texels = "\x32\x64\xc8\x32\x64\xc8" + std::string(2, '\0');
  std::string header = little(124, 4) + little(2, 4) + little(1, 4) + little(1, 2) + little(24, 2) + little(0, 4) +
                       little(texels.size(), 4) + std::string(16 + 16, '\0') + kind + numbers;
  header.resize(108);
  header += little(4, 4) + little(124 + texels.size(), 4) + little(profile.size(), 4) + little(0, 4);
  return "BM" + little(14 + 124 + texels.size() + profile.size(), 4) + little(0, 4) + little(14 + 124, 4) + header +
         texels + profile;
}

std::string targa(unsigned gamma, unsigned below) {
  std::string extension = little(495, 2);
  extension.resize(478);
  extension += little(gamma, 2) + little(below, 2);
  extension.resize(495);
  return std::string("\0\0\2\0\0\0\0\0\0\0\0\0\2\0\1\0\x18\x20", 18) + "\x32\x64\xc8\x32\x64\xc8" + extension +
         little(24, 4) + little(0, 4) + std::string("TRUEVISION-XFILE.\0", 18);
}

void add_bitmaps(Rows& rows) {
  const auto square = [](double v) { return v * v / 65025; };
  const Triple squares{square(200), square(100), square(50)}, bytes{200 / 255.0, 100 / 255.0, 50 / 255.0};
  std::string ends;
  for (const Triple& xyz : srgb_colorants)
    for (const double v : xyz) ends += little(std::uint64_t(std::lround(v * 0x1p30)), 4);
  const std::string two = little(2 << 16, 4);
  rows.push_back({"BMP",
                  "bV4CSType",
                  Becomes::honoured,
                  "squares.bmp",
                  bmp(little(0, 4), ends + two + two + two),
                  squares,
                  {},
                  1e-3});
  rows.push_back({"BMP", "bV4CSType", Becomes::ignored, "none.bmp", bmp(little(0, 4), ""), each(bytes, srgb)});
  rows.push_back({"BMP",
                  "ICC profile",
                  Becomes::honoured,
                  "profile.bmp",
                  bmp("DEBM", "", matrix_profile("Linear sRGB", srgb_colorants, linear_curve)),
                  bytes,
                  {"Linear sRGB"},
                  1e-3});
  rows.push_back(
      {"BMP", "ICC profile", Becomes::refused, "link.bmp", bmp("KNIL", ""), {}, {"not supported", "ICC profile"}});
  rows.push_back({"TGA", "gamma", Becomes::honoured, "squares.tga", targa(20, 10), squares});
  rows.push_back({"TGA", "gamma", Becomes::ignored, "large.tga", targa(200, 10), each(bytes, srgb)});
}

// ---- PSD and WebP ---------------------------------------------------------------------------------------------------

// Adobe, "Photoshop File Formats Specification": two texels, plane by plane, and resource 1039.
std::string psd(int mode, const std::vector<int>& texel, const std::string& profile) {
  const std::string resource =
      "8BIM" + big(1039, 2) + big(0, 2) + big(profile.size(), 4) + profile + std::string(profile.size() % 2, '\0');
  std::string planes;
  for (const int v : texel) planes += std::string(2, static_cast<char>(v));
  return "8BPS" + big(1, 2) + std::string(6, '\0') + big(texel.size(), 2) + big(1, 4) + big(2, 4) + big(8, 2) +
         big(std::uint64_t(mode), 2) + big(0, 4) + big(resource.size(), 4) + resource + big(0, 4) + big(0, 2) + planes;
}

// One of OpenImageIO's with an extended header and a profile before the texels.
std::string webp(int width, int height, const std::array<int, 3>& colour, const std::string& profile) {
  const std::string plain = written_by_openimageio("a.webp", width, height, colour, 3);
  if (plain.empty()) return plain;
  const std::string chunks = "VP8X" + little(10, 4) + little(0x20, 4) + little(std::uint64_t(width - 1), 3) +
                             little(std::uint64_t(height - 1), 3) + "ICCP" + little(profile.size(), 4) + profile +
                             std::string(profile.size() % 2, '\0') + plain.substr(12);
  return "RIFF" + little(4 + chunks.size(), 4) + "WEBP" + chunks;
}

// One of OpenImageIO's with another colour specification box in its header (ISO 15444-1, annex I.5.3).
std::string jpeg2000(int width, int height, const std::array<int, 3>& colour, const std::string& specification) {
  const std::string plain = written_by_openimageio("a.jp2", width, height, colour, 3);
  const std::size_t header = plain.find("jp2h"), box = plain.find("colr");
  if (header == plain.npos || box == plain.npos) return {};
  const auto size_at = [&](std::size_t at) {
    std::size_t size = 0;
    for (std::size_t k = at; k < at + 4; ++k) size = size << 8U | static_cast<unsigned char>(plain[k]);
    return size;
  };
  const std::string made = big(8 + specification.size(), 4) + "colr" + specification;
  return plain.substr(0, header - 4) + big(size_at(header - 4) - size_at(box - 4) + made.size(), 4) +
         plain.substr(header, box - 4 - header) + made + plain.substr(box - 4 + size_at(box - 4));
}

void add_jpeg2000(Rows& rows) {
  const std::string linear = matrix_profile("Linear sRGB", srgb_colorants, linear_curve);
  const auto with = [](const std::string& specification) { return jpeg2000(64, 32, {188, 188, 188}, specification); };
  const double light = 188 / 255.0;
  if (with("").empty()) return;
  rows.push_back({"JPEG 2000",
                  "ICC profile",
                  Becomes::honoured,
                  "profile.jp2",
                  with(std::string("\2\0\0", 3) + linear),
                  {light, light, light},
                  {"Linear sRGB"},
                  0.02});
  rows.push_back({"JPEG 2000",
                  "ICC profile",
                  Becomes::refused,
                  "cut.jp2",
                  with(std::string("\2\0\0", 3) + linear.substr(0, 300)),
                  {},
                  {"ICC profile", "damaged", "--input-space"}});
  rows.push_back({"JPEG 2000",
                  "colour space",
                  Becomes::refused,
                  "lab.jp2",
                  with(std::string("\1\0\0", 3) + big(14, 4)),
                  {},
                  {"not supported", "colour space 14", "--input-space"}});
}

void add_carried(Rows& rows) {
  const std::string linear = matrix_profile("Linear sRGB", srgb_colorants, linear_curve);
  rows.push_back({"PSD",
                  "ICC profile",
                  Becomes::honoured,
                  "profile.psd",
                  psd(3, {200, 100, 50}, linear),
                  {200 / 255.0, 100 / 255.0, 50 / 255.0},
                  {"Linear sRGB"},
                  1e-3});
  const std::string inks = ink_profile();
  rows.push_back({"PSD",
                  "ICC profile",
                  Becomes::honoured,
                  "inks.psd",
                  psd(4, {255, 0, 255, 255}, inks),
                  {0.5, 0.25, 0.125},
                  {"Inks"},
                  1e-3});
  rows.push_back({"GIF",
                  "ICC profile",
                  Becomes::refused,
                  "profile.gif",
                  "GIF89a" + little(2, 2) + little(1, 2) + std::string("\0\0\0!\xff\x0b", 6) + "ICCRGBG1012",
                  {},
                  {"not supported", "ICC profile"}});
  const std::string picture = webp(16, 8, {188, 188, 188}, linear);
  const double light = 188 / 255.0;
  if (!picture.empty())
    rows.push_back({"WebP",
                    "ICC profile",
                    Becomes::honoured,
                    "profile.webp",
                    picture,
                    {light, light, light},
                    {"Linear sRGB"},
                    0.02});
}

// ---- gain maps ------------------------------------------------------------------------------------------------------

const std::string xmp_mark = std::string("http://ns.adobe.com/xap/1.0/\0", 29);

std::string xmp(const std::string& attributes, const std::string& inside = {}) {
  return jpeg_segment(
      1, xmp_mark +
             "<x:xmpmeta xmlns:x='adobe:ns:meta/'><rdf:RDF xmlns:rdf='http://www.w3.org/1999/02/22-rdf-syntax-ns#'>"
             "<rdf:Description xmlns:hdrgm='http://ns.adobe.com/hdr-gain-map/1.0/' "
             "xmlns:Container='http://ns.google.com/photos/1.0/container/' "
             "xmlns:Item='http://ns.google.com/photos/1.0/container/item/' hdrgm:Version='1.0' " +
             attributes + ">" + inside + "</rdf:Description></rdf:RDF></x:xmpmeta>");
}

std::string directory(std::size_t length) {
  return "<Container:Directory><rdf:Seq><rdf:li rdf:parseType='Resource'><Container:Item Item:Semantic='Primary' "
         "Item:Mime='image/jpeg'/></rdf:li><rdf:li rdf:parseType='Resource'><Container:Item Item:Semantic='GainMap' "
         "Item:Mime='image/jpeg' Item:Length='" +
         std::to_string(length) + "'/></rdf:li></rdf:Seq></Container:Directory>";
}

// CIPA DC-007: an index of two images, whose offsets count from its own byte order mark.
std::string index_to(std::size_t offset) {
  return jpeg_segment(2, std::string("MPF\0", 4) + "II*" + std::string(1, '\0') + little(8, 4) + little(1, 2) +
                             little(0xb002, 2) + little(7, 2) + little(32, 4) + little(26, 4) + little(0, 4) +
                             std::string(16, '\0') + little(0, 4) + little(1, 4) + little(offset, 4) + little(0, 4));
}

const std::string iso_mark = std::string("urn:iso:std:iso:ts:21496:-1\0", 28);

std::string fraction(double value) {
  return big(std::uint64_t(std::int64_t(std::lround(value * 1000))), 4) + big(1000, 4);
}

// A picture of 188 and a gain of 128 of 255.
constexpr int base = 188;
const double share = 128 / 255.0;

double gained(double light, double least, double most, double gamma, double below, double above) {
  return (light + below) * std::exp2(least + (most - least) * std::pow(share, 1 / gamma)) - above;
}

void add_gain_maps(Rows& rows) {
  const auto add = [&](Becomes becomes, const std::string& name, const std::string& bytes, double value,
                       const std::vector<std::string>& words = {}, const std::vector<std::string>& options = {}) {
    rows.push_back({"JPEG", "gain map", becomes, name, bytes, {value, value, value}, words, 2e-3, options});
  };
  const double light = srgb(base / 255.0);
  const std::array<int, 3> picture{base, base, base}, gain{128, 128, 128};
  const std::string plain = jpeg(2, 2, gain, xmp("hdrgm:GainMapMax='16' hdrgm:HDRCapacityMax='16'"), 1);
  const std::string with_items = jpeg(16, 8, picture, xmp("", directory(plain.size()))) + plain;
  const double whole = gained(light, 0, 16, 1, 1 / 64.0, 1 / 64.0);
  add(Becomes::honoured, "items.jpg", with_items, whole, {"hdrgm 1.0", "0 to 16 stops", "steps of 4.4%"});
  add(Becomes::honoured, "half.jpg", with_items, (light + 1 / 64.0) * std::exp2(8 * share) - 1 / 64.0,
      {"8 of 16 stops"}, {"--headroom", "8"});
  // The index comes behind the XMP; the gain map begins where the picture ends.
  const std::string announced = xmp("");
  const std::string odd = jpeg(4, 4, gain,
                               xmp("hdrgm:GainMapMin='-1' hdrgm:GainMapMax='3' hdrgm:Gamma='2' hdrgm:OffsetSDR='0.1' "
                                   "hdrgm:OffsetHDR='0.2' hdrgm:HDRCapacityMin='0' hdrgm:HDRCapacityMax='3'"),
                               1);
  const std::size_t size = jpeg(16, 8, picture, announced + index_to(1)).size();
  const std::size_t origin = 2 + announced.size() + 8;
  add(Becomes::honoured, "index.jpg", jpeg(16, 8, picture, announced + index_to(size - origin)) + odd,
      gained(light, -1, 3, 2, 0.1, 0.2));
  // ISO 21496-1, in three channels that are alike.
  std::string numbers = big(0, 2) + big(0, 2) + big(0xc0, 1) + fraction(0) + fraction(4);
  for (int c = 0; c < 3; ++c) numbers += fraction(-1) + fraction(4) + fraction(2) + fraction(0.1) + fraction(0.2);
  const std::string iso = jpeg(4, 4, gain, jpeg_segment(2, iso_mark + numbers));
  const std::string by_iso = jpeg_segment(2, iso_mark + big(0, 4));
  const std::size_t iso_size = jpeg(16, 8, picture, by_iso + index_to(1)).size(), iso_origin = 2 + by_iso.size() + 8;
  add(Becomes::honoured, "iso.jpg", jpeg(16, 8, picture, by_iso + index_to(iso_size - iso_origin)) + iso,
      gained(light, -1, 4, 2, 0.1, 0.2), {"ISO 21496-1", "3 channels"});
  add(Becomes::refused, "gone.jpg", jpeg(16, 8, picture, announced), 0, {"damaged", "gain map", "--headroom 0"});
  const auto refused = [&](const std::string& name, const std::string& attributes, const std::string& word) {
    const std::string map = jpeg(2, 2, gain, xmp(attributes), 1);
    add(Becomes::refused, name, jpeg(16, 8, picture, xmp("", directory(map.size()))) + map, 0,
        {"gain map", word, "--headroom 0"});
  };
  refused("hdr-base.jpg", "hdrgm:GainMapMax='4' hdrgm:HDRCapacityMax='4' hdrgm:BaseRenditionIsHDR='True'",
          "not supported");
  refused("gamma.jpg", "hdrgm:GainMapMax='4' hdrgm:HDRCapacityMax='4' hdrgm:Gamma='0'", "damaged");
  refused("headroom.jpg", "hdrgm:GainMapMax='4'", "HDRCapacityMax");
}

void add_jpeg(Rows& rows) {
  const std::string profile = matrix_profile("Linear sRGB", srgb_colorants, linear_curve);
  const auto with = [&](const std::string& segments) { return jpeg(16, 8, {base, base, base}, segments); };
  const std::string mark("ICC_PROFILE\0", 12);
  const std::string two =
      jpeg_segment(2, mark + "\2\2" + profile.substr(100)) + jpeg_segment(2, mark + "\1\2" + profile.substr(0, 100));
  const double light = base / 255.0;
  rows.push_back(
      {"JPEG", "ICC profile", Becomes::honoured, "chunks.jpg", with(two), {light, light, light}, {"Linear sRGB"}});
  rows.push_back({"JPEG",
                  "ICC profile",
                  Becomes::refused,
                  "missing.jpg",
                  with(jpeg_segment(2, mark + "\1\2" + profile)),
                  {},
                  {"ICC profile", "chunks"}});
  add_gain_maps(rows);
}

}  // namespace

std::vector<ClaimRow> claims_of_colour() {
  Rows rows;
  add_radiance(rows);
  add_profiles(rows);
  add_png(rows);
  add_tiff(rows);
  add_jpeg(rows);
  add_bitmaps(rows);
  add_carried(rows);
  add_jpeg2000(rows);
  return rows;
}

}  // namespace command_tests
