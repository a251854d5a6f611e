// PNG images of all kinds, written by libpng's writer and read by OpenImageIO, too, which is another reader.
#include "envmap/io/formats/png.h"

#include <gtest/gtest.h>
#include <png.h>

#include "envmap/base/error.h"
#include "envmap/io/formats/openimageio_module.h"
#include "unit/texels_read.h"

namespace envmap::png_test {
namespace {

struct Kind {
  int colours, bits;
  bool interlaced = false, transparent = false;  // By tRNS.
};

struct Writer {
  std::string file = {};
  png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, nullptr, nullptr);
  png_infop info = png_create_info_struct(png);

  Writer() {
    png_set_write_fn(
        png, &file,
        [](png_structp p, png_bytep bytes, png_size_t size) {
          static_cast<std::string*>(png_get_io_ptr(p))->append(reinterpret_cast<const char*>(bytes), size);
        },
        nullptr);
  }
  ~Writer() { png_destroy_write_struct(&png, &info); }
  Writer(const Writer&) = delete;
};

// @param more chunks that go before the texels. Bytes of rows are random, so that every value is there.
template <class More>
std::string png_file(const Kind& kind, int width, int height, const More& more) {
  Writer w;
  png_set_IHDR(w.png, w.info, png_uint_32(width), png_uint_32(height), kind.bits, kind.colours,
               kind.interlaced ? PNG_INTERLACE_ADAM7 : PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT,
               PNG_FILTER_TYPE_DEFAULT);
  std::mt19937 random(unsigned(kind.colours * 100 + kind.bits));
  std::vector<png_color> palette(std::size_t{1} << unsigned(std::min(kind.bits, 8)));
  for (png_color& c : palette) c = {png_byte(random()), png_byte(random()), png_byte(random())};
  if (kind.colours == PNG_COLOR_TYPE_PALETTE) png_set_PLTE(w.png, w.info, palette.data(), int(palette.size()));
  const png_byte alphas[] = {0, 100};
  const png_color_16 clear{.index = 0, .red = 1, .green = 2, .blue = 3, .gray = 1};
  if (kind.transparent) png_set_tRNS(w.png, w.info, alphas, 2, &clear);
  more(w.png, w.info);
  png_write_info(w.png, w.info);
  std::vector<png_byte> bytes(png_get_rowbytes(w.png, w.info) * std::size_t(height));
  for (png_byte& b : bytes) b = png_byte(random());
  std::vector<png_bytep> rows;
  for (int y = 0; y < height; ++y) rows.push_back(bytes.data() + std::size_t(y) * (bytes.size() / std::size_t(height)));
  png_write_image(w.png, rows.data());
  png_write_end(w.png, w.info);
  return w.file;
}

std::string png_file(const Kind& kind, int width = 37, int height = 21) {
  return png_file(kind, width, height, [](png_structp, png_infop) {});
}

std::vector<Kind> all_kinds() {
  std::vector<Kind> kinds;
  for (const bool interlaced : {false, true}) {
    for (const int bits : {1, 2, 4, 8, 16}) {
      kinds.push_back({PNG_COLOR_TYPE_GRAY, bits, interlaced});
      kinds.push_back({PNG_COLOR_TYPE_GRAY, bits, interlaced, true});
      if (bits < 16) kinds.push_back({PNG_COLOR_TYPE_PALETTE, bits, interlaced});
      if (bits < 16) kinds.push_back({PNG_COLOR_TYPE_PALETTE, bits, interlaced, true});
      if (bits < 8) continue;
      for (const int colours : {PNG_COLOR_TYPE_GRAY_ALPHA, PNG_COLOR_TYPE_RGB, PNG_COLOR_TYPE_RGB_ALPHA})
        kinds.push_back({colours, bits, interlaced});
      kinds.push_back({PNG_COLOR_TYPE_RGB, bits, interlaced, true});
    }
  }
  return kinds;
}

ImageReader read_by_openimageio(const std::string& file) { return formats().open("png", "a.png", file, true, false); }

TEST(Png, AllKindsAreReadAsOpenImageIoReadsThem) {
  for (const Kind& kind : all_kinds()) {
    SCOPED_TRACE(fmt::format("{} {} {} {}", kind.colours, kind.bits, kind.interlaced, kind.transparent));
    const std::string bytes = png_file(kind);
    const InputFile file{std::span<const char>(bytes)};
    const ImageReader reader = open_png(file, true).value();
    const ImageReader judge = openimageio_judges ? read_by_openimageio(bytes) : open_png(file, true).value();
    expect_same_facts(reader.facts, judge.facts);
    EXPECT_EQ(texels(reader), texels(judge));
    const int last = int(reader.facts.channels.size()) - 1;
    EXPECT_EQ(texels(reader, 15, 18, last, 1), texels(judge, 15, 18, last, 1)) << "rows go back";
    EXPECT_EQ(texels(reader, 20, 21, 0, 1), texels(judge, 20, 21, 0, 1)) << "rows are passed over";
  }
}

TEST(Png, AllValuesOf16Bits) {
  const std::string bytes = png_file({PNG_COLOR_TYPE_GRAY, 16}, 1024, 512);
  const InputFile file{std::span<const char>(bytes)};
  EXPECT_EQ(texels(open_png(file, true).value()), texels(read_by_openimageio(bytes)));
}

TEST(Png, ColoursAreMultipliedByAlpha) {
  for (const int bits : {8, 16}) {
    const std::string bytes = png_file({PNG_COLOR_TYPE_RGB_ALPHA, bits});
    const InputFile file{std::span<const char>(bytes)};
    const std::vector<float> straight = texels(open_png(file, true).value()),
                             is = texels(open_png(file, false).value());
    const double most = bits == 8 ? 255 : 65535;
    for (std::size_t k = 0; k < is.size(); ++k) {
      const double colour = std::round(straight[k] * most), alpha = std::round(straight[k | 3U] * most);
      ASSERT_NEAR(is[k] * most, k % 4 == 3 ? alpha : std::floor(colour * alpha / most), 0.01) << k;
    }
  }
}

TEST(Png, CurvesAndTextsAreThoseThatOpenImageIoFinds) {
  const auto check = [](const auto& more) {
    const std::string bytes = png_file({PNG_COLOR_TYPE_RGB, 8}, 4, 4, more);
    const InputFile file{std::span<const char>(bytes)};
    const ImageReader reader = open_png(file, false).value(), judge = read_by_openimageio(bytes);
    expect_same_facts(reader.facts, judge.facts);
    for (const auto& [name, text] : reader.facts.attributes) EXPECT_EQ(judge.facts.attributes.at(name), text);
    return reader.facts;
  };
  EXPECT_TRUE(check([](png_structp p, png_infop i) { png_set_sRGB(p, i, PNG_sRGB_INTENT_RELATIVE); }).encoded);
  EXPECT_TRUE(check([](png_structp p, png_infop i) { png_set_gAMA(p, i, 0.45455); }).encoded);
  EXPECT_FALSE(check([](png_structp p, png_infop i) { png_set_gAMA(p, i, 1); }).encoded);
  EXPECT_FALSE(check([](png_structp p, png_infop i) { png_set_gAMA(p, i, 0.999); }).encoded);
  EXPECT_TRUE(check([](png_structp p, png_infop i) { png_set_gAMA(p, i, 0.9); }).encoded);
  char keys[3][12] = {"Description", "Author", "description"}, words[3][8] = {"a=1", "J\u00fcrgen", "b=2"};
  const Attributes texts = check([&](png_structp p, png_infop i) {
                             for (int k = 0; k < 3; ++k) {
                               png_text t{};
                               t.compression = PNG_ITXT_COMPRESSION_NONE;
                               t.key = keys[k], t.text = words[k];
                               png_set_text(p, i, &t, 1);
                             }
                           }).attributes;
  EXPECT_EQ(texts, (Attributes{{description, "b=2"}, {"Artist", "J\u00fcrgen"}}));
}

// EXIF's orientation 6, in a directory of one entry.
TEST(Png, ExifTellsTheOrientation) {
  png_byte exif[] = {'M', 'M', 0, 42, 0, 0, 0, 8, 0, 1, 1, 18, 0, 3, 0, 0, 0, 1, 0, 6, 0, 0, 0, 0, 0, 0};
  const std::string bytes = png_file({PNG_COLOR_TYPE_RGB, 8}, 4, 4,
                                     [&](png_structp p, png_infop i) { png_set_eXIf_1(p, i, sizeof exif, exif); });
  const InputFile file{std::span<const char>(bytes)};
  EXPECT_EQ(open_png(file, false).value().facts.orientation, Orientation::right_top);
  // The chunk may also follow the texels.
  const std::size_t at = bytes.find("eXIf") - 4, size = 12 + sizeof exif;
  std::string after = bytes.substr(0, at) + bytes.substr(at + size);
  after.insert(after.find("IEND") - 4, bytes.substr(at, size));
  const InputFile other{std::span<const char>(after)};
  EXPECT_EQ(open_png(other, false).value().facts.orientation, Orientation::right_top);
}

// A place on a page is none on the sphere.
TEST(Png, AnOffsetIsIgnored) {
  const std::string bytes = png_file({PNG_COLOR_TYPE_RGB, 8}, 4, 4, [&](png_structp p, png_infop i) {
    png_set_oFFs(p, i, 100, 50, PNG_OFFSET_PIXEL);
  });
  const InputFile file{std::span<const char>(bytes)};
  EXPECT_EQ(open_png(file, false).value().facts.claims.back().name, "oFFs");
}

TEST(Png, CutImagesAreRefused) {
  for (const Kind kind : {Kind{PNG_COLOR_TYPE_RGB, 16}, Kind{PNG_COLOR_TYPE_PALETTE, 4, true, true}}) {
    const std::string whole = png_file(kind);
    const std::size_t texels_end = whole.size() - 16;  // What follows is the checksum of the texels, and IEND.
    for (std::size_t size = 0; size < texels_end; size += 3) {
      const InputFile file{std::span(whole).first(size)};
      EXPECT_THROW(texels(open_png(file, false).value()), InputError) << size;
    }
  }
}

// Each byte of the file changed, the checksums as they were: refused or read, as the place has it.
TEST(Png, ChangedImagesAreReadOrRefused) {
  const std::string whole = png_file({PNG_COLOR_TYPE_RGB_ALPHA, 8, true}, 9, 9);
  int refused = 0;
  for (std::size_t at = 0; at < whole.size(); ++at) {
    std::string odd = whole;
    odd[at] = char(odd[at] ^ 0x41);
    const InputFile file{std::span<const char>(odd)};
    try {
      if (const auto reader = open_png(file, false)) (void)texels(*reader);
    } catch (const InputError& e) {
      EXPECT_EQ(std::string(e.what()).find('\n'), std::string::npos);
      ++refused;
    }
  }
  EXPECT_GT(refused, int(whole.size()) * 9 / 10);
}

}  // namespace
}  // namespace envmap::png_test
