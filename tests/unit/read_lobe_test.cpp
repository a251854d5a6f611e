// Tables of lobes in text files, and materials of the MERL database that are written here by formulae.
#include "envmap/io/read_lobe.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <numbers>
#include <random>

#include "envmap/base/error.h"
#include "envmap/operate/generate.h"
#include "envmap/operate/measure.h"
#include "envmap/prefilter/prefilter.h"

namespace envmap::read_lobe_test {
namespace {

namespace fs = std::filesystem;

class ReadLobe : public testing::Test {
 protected:
  fs::path path = fs::temp_directory_path() / ("envmap-lobe-" + std::to_string(::getpid()));
  ~ReadLobe() override { fs::remove(path); }

  [[nodiscard]] Lobe of(const std::string& text) const {
    std::ofstream(path, std::ios::binary) << text;
    return read_lobe(path.string());
  }
  void refuses(const std::string& words, const std::string& text) const {
    try {
      (void)of(text);
      ADD_FAILURE() << words;
    } catch (const InputError& e) {
      EXPECT_EQ(e.what(), path.string() + ": " + words);
    }
  }
};

TEST_F(ReadLobe, OfCosines) {
  const Lobe lobe = of("# gloss\n\n1 2.5\r\n0.5,\t1e-1 # half way\n 0  0");
  ASSERT_EQ(lobe.samples().size(), 3U);
  EXPECT_EQ(lobe.samples()[0].cosine, 0);
  EXPECT_EQ(lobe.samples()[1].cosine, 0.5);
  EXPECT_EQ(lobe.samples()[1].value, 0.1);
  EXPECT_EQ(lobe.samples()[2].value, 2.5);
}

TEST_F(ReadLobe, OfDegrees) {
  const Lobe lobe = of("degrees\n0 1\n60 0.25\n90 0\n");
  ASSERT_EQ(lobe.samples().size(), 3U);
  EXPECT_EQ(lobe.samples()[0].cosine, 0);
  EXPECT_NEAR(lobe.samples()[1].cosine, 0.5, 1e-15);
  EXPECT_EQ(lobe.samples()[2].cosine, 1);
}

TEST_F(ReadLobe, OfNothingElse) {
  refuses("a table needs two samples or more, not 0", "");
  refuses("line 2: must be a cosine and a value, such as '0.9 0.5'", "1 1\n0.5\n");
  refuses("line 1: must be a cosine and a value, such as '0.9 0.5'", "1 1 1\n0.5 1\n");
  refuses("line 2: must be an angle in degrees and a value, such as '30 0.5'", "degrees\n0 x\n");
  refuses("line 3: the angle must be 0 to 90 degrees, not 91", "degrees\n0 1\n91 1\n");
  refuses("line 2: must be a cosine and a value, such as '0.9 0.5'", "1 1\ndegrees\n");
  refuses("sample 2: value must be finite and not negative, not nan", "1 1\n0 nan\n");
  refuses("is neither a table of a lobe nor a MERL material", std::string("1 1\n\0", 5));
  fs::remove(path);
  EXPECT_THROW((void)read_lobe(path.string()), InputError);
  EXPECT_THROW((void)read_lobe("/dev/zero"), InputError);
}

TEST_F(ReadLobe, AnyBytesAreALobeOrAnError) {
  std::mt19937 random(3);
  const std::string alphabet = "0123456789.,-+e \n\t#naif\xff";
  for (int k = 0; k < 2000; ++k) {
    std::string text;
    for (unsigned n = random() % 60; n > 0; --n) text += alphabet[random() % alphabet.size()];
    try {
      EXPECT_GE(of(text).samples().size(), 2U);
    } catch (const InputError& e) {
      EXPECT_EQ(std::string(e.what()).find('\n'), std::string::npos);
    }
  }
}

// A material whose BRDF is a formula of the half angle, in the units of the file, red alone unless `grey`.
template <class F>
void write_merl(const fs::path& path, const F& brdf, double green_and_blue = 1) {
  std::ofstream file(path, std::ios::binary);
  const int bins[3] = {90, 90, 180};
  file.write(reinterpret_cast<const char*>(bins), sizeof bins);
  const double scales[3] = {1.0 / 1500, 1.15 / 1500, 1.66 / 1500};
  for (int c = 0; c < 3; ++c)
    for (int half = 0; half < 90; ++half) {
      const double angle = std::pow((half + 0.5) / 90, 2) * std::numbers::pi / 2;
      const std::vector<double> same(90 * 180, brdf(angle) / scales[c] * (c > 0 ? green_and_blue : 1));
      file.write(reinterpret_cast<const char*>(same.data()), std::streamsize(same.size() * sizeof(double)));
    }
}

// cos(n,h)^m as a BRDF is Blinn's lobe, of the closed form that blinn-phong has.
TEST_F(ReadLobe, AMaterialOfBlinnsFormIsBlinnPhong) {
  write_merl(path, [](double half) { return 0.3 * std::pow(std::cos(half), 40); });
  const Lobe lobe = read_lobe(path.string());
  EXPECT_EQ(lobe.samples().size(), 66U);
  EXPECT_NEAR(lobe.samples().back().value, 0.3, 1e-3) << "the BRDF itself, in 1/sr";
  const Prefilterer sky(generate(Sky{}, Projection::latlong, 32));
  const Prefiltered table = sky.make({.lobe = lobe, .size = 4}),
                    blinn = sky.make({.lobe = Lobe::blinn_phong(40), .size = 4});
  for (const Texel& t : texels_of(table.map.base()))
    EXPECT_NEAR(double(table.map.base().texel(t.face, t.i, t.j)->z / blinn.map.base().texel(t.face, t.i, t.j)->z), 1,
                6e-3);
}

TEST_F(ReadLobe, ColoursOfAMaterialCountByLuminance) {
  write_merl(
      path, [](double) { return 1; }, 0);
  EXPECT_NEAR(read_lobe(path.string()).samples().back().value, 0.2126, 1e-12);
}

TEST_F(ReadLobe, BinsThatWereNotMeasuredAreLeftOut) {
  write_merl(path, [](double half) { return half > 0.5 ? -1.0 : 1.0; });
  const Lobe lobe = read_lobe(path.string());
  EXPECT_NEAR(lobe.samples()[1].cosine, std::cos(2 * 0.5), 0.03);
  write_merl(path, [](double) { return -1.0; });
  EXPECT_THROW((void)read_lobe(path.string()), InputError);
}

TEST_F(ReadLobe, CutMaterialsAreRefused) {
  write_merl(path, [](double) { return 1.0; });
  fs::resize_file(path, fs::file_size(path) - 1);
  try {
    (void)read_lobe(path.string());
    ADD_FAILURE();
  } catch (const InputError& e) {
    EXPECT_EQ(e.what(), path.string() + ": an isotropic MERL material has 34992012 bytes, not 34992011");
  }
}

}  // namespace
}  // namespace envmap::read_lobe_test
