// TIFF images of all kinds, written by libtiff. OpenImageIO is the other reader.
#include "envmap/io/formats/tiff.h"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <tiffio.h>
#include <unistd.h>

#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>

#include "envmap/base/error.h"
#include "envmap/io/formats/openimageio_module.h"
#include "unit/texels_read.h"

namespace envmap::tiff_test {
namespace {

struct Kind {
  int samples = 3, bits = 8, compression = COMPRESSION_NONE;
  bool floating = false;
  const char* mode = "wl";  // Little or big endian; 8 for BigTIFF.
  int rows_per_strip = 4;
};

// Files are written by name: libtiff has no memory to write to.
template <class Fill>
std::string written(const Fill& fill, const char* mode = "wl") {
  const std::string path = testing::TempDir() + fmt::format("envmap-tiff-test-{}.tif", getpid());
  TIFF* const t = TIFFOpen(path.c_str(), mode);
  fill(t);
  TIFFClose(t);
  std::ifstream stream(path, std::ios::binary);
  std::string bytes{std::istreambuf_iterator<char>(stream), {}};
  std::filesystem::remove(path);
  return bytes;
}

// Random texels. @param more sets further tags.
template <class More>
void fill(TIFF* t, const Kind& kind, int width, int height, const More& more) {
  TIFFSetField(t, TIFFTAG_IMAGEWIDTH, width);
  TIFFSetField(t, TIFFTAG_IMAGELENGTH, height);
  TIFFSetField(t, TIFFTAG_SAMPLESPERPIXEL, kind.samples);
  TIFFSetField(t, TIFFTAG_BITSPERSAMPLE, kind.bits);
  TIFFSetField(t, TIFFTAG_SAMPLEFORMAT, kind.floating ? SAMPLEFORMAT_IEEEFP : SAMPLEFORMAT_UINT);
  TIFFSetField(t, TIFFTAG_PHOTOMETRIC, kind.samples == 1 ? PHOTOMETRIC_MINISBLACK : PHOTOMETRIC_RGB);
  TIFFSetField(t, TIFFTAG_PLANARCONFIG, PLANARCONFIG_CONTIG);
  TIFFSetField(t, TIFFTAG_COMPRESSION, kind.compression);
  TIFFSetField(t, TIFFTAG_ROWSPERSTRIP, kind.rows_per_strip);
  const std::uint16_t associated = EXTRASAMPLE_ASSOCALPHA;
  if (kind.samples == 4) TIFFSetField(t, TIFFTAG_EXTRASAMPLES, 1, &associated);
  more(t);
  if (TIFFIsTiled(t)) {  // One black tile.
    std::vector<unsigned char> tile(std::size_t(TIFFTileSize(t)));
    TIFFWriteEncodedTile(t, 0, tile.data(), TIFFTileSize(t));
    return;
  }
  std::mt19937 random(unsigned(kind.bits + kind.samples));
  std::vector<unsigned char> row(std::size_t(width * kind.samples * kind.bits / 8));
  for (int y = 0; y < height; ++y) {
    for (unsigned char& byte : row) byte = static_cast<unsigned char>(random());
    // Floats of finite exponents.
    for (std::size_t k = 0; kind.floating && k < row.size(); k += std::size_t(kind.bits / 8))
      row[k + std::size_t(kind.bits / 8) - 1] = 0x3a + k % 3;
    TIFFWriteScanline(t, row.data(), std::uint32_t(y), 0);
  }
}

template <class More>
std::string tiff_file(const Kind& kind, int width, int height, const More& more) {
  return written([&](TIFF* t) { fill(t, kind, width, height, more); }, kind.mode);
}

std::string tiff_file(const Kind& kind, int width = 37, int height = 21) {
  return tiff_file(kind, width, height, [](TIFF*) {});
}

ImageReader read_by_openimageio(const std::string& file) { return formats().open("tiff", "a.tif", file, false, false); }

void expect_same_words(const ImageFacts& is, const ImageFacts& wanted) {
  expect_same_facts(is, wanted);
  EXPECT_EQ(is.orientation, wanted.orientation);
  for (const auto& [name, text] : is.attributes) EXPECT_EQ(wanted.attributes.at(name), text);
}

std::vector<Kind> all_kinds() {
  std::vector<Kind> kinds;
  for (const int samples : {1, 3, 4})
    for (const int compression :
         {COMPRESSION_NONE, COMPRESSION_LZW, COMPRESSION_DEFLATE, COMPRESSION_ADOBE_DEFLATE, COMPRESSION_PACKBITS})
      for (const char* mode : {"wl", "wb", "wl8", "wb8"}) {
        for (const int bits : {8, 16}) kinds.push_back({samples, bits, compression, false, mode});
        for (const int bits : {16, 32}) kinds.push_back({samples, bits, compression, true, mode});
      }
  return kinds;
}

TEST(Tiff, AllKindsAreReadAsOpenImageIoReadsThem) {
  for (const Kind& kind : all_kinds())
    for (const auto& [width, height] : {std::pair(37, 21), std::pair(1, 1)}) {
      SCOPED_TRACE(fmt::format("{} x {} bits, {}, {}", kind.samples, kind.bits, kind.compression, kind.mode));
      const std::string bytes = tiff_file(kind, width, height);
      const InputFile file{std::span<const char>(bytes)};
      const ImageReader reader = open_tiff(file).value();
      const ImageReader judge = openimageio_judges ? read_by_openimageio(bytes) : open_tiff(file).value();
      expect_same_words(reader.facts, judge.facts);
      EXPECT_EQ(texels(reader), texels(judge));
      if (height < 21) continue;
      const int last = kind.samples - 1;
      EXPECT_EQ(texels(reader, 15, 18, last, 1), texels(judge, 15, 18, last, 1)) << "rows go back";
      EXPECT_EQ(texels(reader, 20, 21, 0, 1), texels(judge, 20, 21, 0, 1)) << "rows are passed over";
    }
}

TEST(Tiff, PredictorsAndOneStrip) {
  for (const Kind kind : {Kind{3, 16, COMPRESSION_LZW}, Kind{3, 32, COMPRESSION_ADOBE_DEFLATE, true}}) {
    const std::string bytes = tiff_file(kind, 37, 21, [&](TIFF* t) {
      TIFFSetField(t, TIFFTAG_PREDICTOR, kind.floating ? PREDICTOR_FLOATINGPOINT : PREDICTOR_HORIZONTAL);
      TIFFSetField(t, TIFFTAG_ROWSPERSTRIP, 100);
    });
    const InputFile file{std::span<const char>(bytes)};
    EXPECT_EQ(texels(open_tiff(file).value()), texels(read_by_openimageio(bytes)));
  }
}

TEST(Tiff, OrientationAndTextsAreThoseThatOpenImageIoFinds) {
  for (int way = 1; way <= 8; ++way) {
    const std::string bytes = tiff_file({}, 4, 4, [&](TIFF* t) {
      TIFFSetField(t, TIFFTAG_ORIENTATION, way);
      TIFFSetField(t, TIFFTAG_IMAGEDESCRIPTION, "some words");
      TIFFSetField(t, TIFFTAG_COPYRIGHT, "J\u00fcrgen");
    });
    const InputFile file{std::span<const char>(bytes)};
    const ImageFacts facts = open_tiff(file).value().facts;
    expect_same_words(facts, read_by_openimageio(bytes).facts);
    EXPECT_EQ(int(facts.orientation), way);
    EXPECT_EQ(facts.attributes, (Attributes{{description, "some words"}, {copyright, "J\u00fcrgen"}}));
  }
}

TEST(Tiff, RareImagesAreLeftToOpenImageIo) {
  const auto is_read = [](const Kind& kind, const auto& more) {
    const std::string bytes = tiff_file(kind, 16, 16, more);
    const InputFile file{std::span<const char>(bytes)};
    return open_tiff(file).has_value();
  };
  const auto with = [&](unsigned tag, auto value) {
    return is_read({}, [&](TIFF* t) { TIFFSetField(t, tag, value); });
  };
  EXPECT_TRUE(with(TIFFTAG_IMAGEDESCRIPTION, "words"));
  EXPECT_FALSE(with(TIFFTAG_IMAGEDESCRIPTION, "SHA-1=0"));
  EXPECT_FALSE(with(TIFFTAG_XPOSITION, 2.0));
  EXPECT_FALSE(with(TIFFTAG_PIXAR_IMAGEFULLWIDTH, 32));
  EXPECT_FALSE(with(TIFFTAG_PIXAR_TEXTUREFORMAT, "LatLong Environment"));
  EXPECT_FALSE(with(TIFFTAG_PLANARCONFIG, PLANARCONFIG_SEPARATE));
  EXPECT_THROW(with(TIFFTAG_PHOTOMETRIC, PHOTOMETRIC_CIELAB), InputError);
  const auto tiles = [](TIFF* t) {
    TIFFSetField(t, TIFFTAG_TILEWIDTH, 16);
    TIFFSetField(t, TIFFTAG_TILELENGTH, 16);
  };
  EXPECT_FALSE(is_read({}, tiles));
  EXPECT_THROW(is_read({3, 64, COMPRESSION_NONE, true}, tiles), InputError);
  EXPECT_THROW(is_read({4, 8}, [&](TIFF* t) { TIFFSetField(t, TIFFTAG_PHOTOMETRIC, PHOTOMETRIC_SEPARATED), tiles(t); }),
               InputError);
  const auto xmp = [&](const std::string& text) {
    return is_read({}, [&](TIFF* t) { TIFFSetField(t, TIFFTAG_XMLPACKET, int(text.size()), text.data()); });
  };
  EXPECT_TRUE(xmp("<rdf:Description GPano:ProjectionType='equirectangular'/>"));
  EXPECT_FALSE(xmp("<rdf:Description tiff:Orientation='3'/>"));
  EXPECT_FALSE(is_read({3, 32}, [](TIFF*) {})) << "32 bits, unsigned";
  EXPECT_FALSE(is_read({2, 8}, [](TIFF*) {}));
  const std::uint16_t straight = EXTRASAMPLE_UNASSALPHA;
  EXPECT_FALSE(is_read({4, 8}, [&](TIFF* t) { TIFFSetField(t, TIFFTAG_EXTRASAMPLES, 1, &straight); }));
  const std::string large = tiff_file({3, 32, COMPRESSION_PACKBITS, true, "wl", 64}, 2048, 1024);
  const InputFile file{std::span<const char>(large)};
  EXPECT_FALSE(open_tiff(file).has_value()) << "its strips are decompressed in parallel";
}

// Of which OpenImageIO cannot go back in a strip.
TEST(Tiff, CompressedPlanesOfDoubles) {
  const auto value = [](int x, int y, int c) { return 1000.0 * c + 10 * y + 0.125 * x; };
  const std::string bytes = written([&](TIFF* t) {
    TIFFSetField(t, TIFFTAG_IMAGEWIDTH, 7);
    TIFFSetField(t, TIFFTAG_IMAGELENGTH, 8);
    TIFFSetField(t, TIFFTAG_SAMPLESPERPIXEL, 3);
    TIFFSetField(t, TIFFTAG_BITSPERSAMPLE, 64);
    TIFFSetField(t, TIFFTAG_SAMPLEFORMAT, SAMPLEFORMAT_IEEEFP);
    TIFFSetField(t, TIFFTAG_PHOTOMETRIC, PHOTOMETRIC_RGB);
    TIFFSetField(t, TIFFTAG_PLANARCONFIG, PLANARCONFIG_SEPARATE);
    TIFFSetField(t, TIFFTAG_COMPRESSION, COMPRESSION_LZW);
    TIFFSetField(t, TIFFTAG_ROWSPERSTRIP, 3);
    for (int c = 0; c < 3; ++c)
      for (int y = 0; y < 8; ++y) {
        std::array<double, 7> row = {};
        for (int x = 0; x < 7; ++x) row[std::size_t(x)] = value(x, y, c);
        TIFFWriteScanline(t, row.data(), std::uint32_t(y), std::uint16_t(c));
      }
  });
  const InputFile file{std::span<const char>(bytes)};
  const ImageReader reader = open_tiff(file).value();
  const std::vector<float> is = texels(reader), blue = texels(reader, 2, 5, 2, 1);
  for (int y = 0; y < 8; ++y)
    for (int x = 0; x < 7; ++x)
      for (int c = 0; c < 3; ++c) ASSERT_EQ(is[std::size_t((y * 7 + x) * 3 + c)], float(value(x, y, c)));
  for (int y = 2; y < 5; ++y) EXPECT_EQ(blue[std::size_t((y - 2) * 7)], float(value(0, y, 2))) << "rows go back";
}

TEST(Tiff, CutImagesAreRefused) {
  for (const Kind kind : {Kind{3, 16}, Kind{3, 32, COMPRESSION_LZW, true}}) {
    const std::string whole = tiff_file(kind);
    for (std::size_t size = 0; size < whole.size(); size += 3) {
      const InputFile file{std::span(whole).first(size)};
      EXPECT_THROW(texels(open_tiff(file).value()), InputError) << size;
    }
  }
}

// Each byte of the header and of the directory changed: refused or read, as the place has it.
TEST(Tiff, ChangedImagesAreReadOrRefused) {
  for (const Kind kind : {Kind{3, 16}, Kind{4, 32, COMPRESSION_ADOBE_DEFLATE, true, "wb8"}}) {
    const std::string whole = tiff_file(kind, 9, 9);
    int refused = 0;
    for (std::size_t at = 0; at < whole.size(); ++at) {
      std::string odd = whole;
      odd[at] = char(odd[at] ^ 0x41);
      const InputFile file{std::span<const char>(odd)};
      try {
        const auto reader = open_tiff(file);
        if (reader && std::max(reader->facts.width, reader->facts.height) < 10000) (void)texels(*reader);
      } catch (const InputError& e) {
        EXPECT_EQ(std::string(e.what()).find('\n'), std::string::npos);
        ++refused;
      }
    }
    EXPECT_GT(refused, 30);
  }
}

}  // namespace
}  // namespace envmap::tiff_test
