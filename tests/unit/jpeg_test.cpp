// JPEG images of all kinds, written by libjpeg's encoder. OpenImageIO is the other reader.
#include "envmap/io/formats/jpeg.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

// The second needs the first.
// clang-format off
#include <cstdio>
#include <jpeglib.h>
// clang-format on

#include <random>

#include "envmap/base/error.h"
#include "envmap/io/formats/openimageio_module.h"
#include "unit/texels_read.h"

namespace envmap::jpeg_test {
namespace {

struct Kind {
  J_COLOR_SPACE input, stored;
  int horizontal = 1, vertical = 1;  // Samples of the first channel for one of the others.
  bool progressive = false, arithmetic = false;
  std::vector<jpeg_scan_info> scans = {};  // Where libjpeg's own script is not meant.
};

struct Marker {
  int kind;
  std::string bytes;
};

std::string jpeg_file(const Kind& kind, int width = 37, int height = 21, const std::vector<Marker>& markers = {}) {
  jpeg_compress_struct j{};
  jpeg_error_mgr errors{};
  j.err = jpeg_std_error(&errors);
  jpeg_create_compress(&j);
  unsigned char* bytes = nullptr;
  unsigned long size = 0;
  jpeg_mem_dest(&j, &bytes, &size);
  j.image_width = JDIMENSION(width), j.image_height = JDIMENSION(height);
  j.in_color_space = kind.input;
  j.input_components = kind.input == JCS_CMYK ? 4 : kind.input == JCS_GRAYSCALE ? 1 : 3;
  jpeg_set_defaults(&j);
  jpeg_set_colorspace(&j, kind.stored);
  j.comp_info[0].h_samp_factor = kind.horizontal, j.comp_info[0].v_samp_factor = kind.vertical;
  j.arith_code = kind.arithmetic ? TRUE : FALSE;
  if (kind.progressive) jpeg_simple_progression(&j);
  if (!kind.scans.empty()) j.scan_info = kind.scans.data(), j.num_scans = int(kind.scans.size());
  jpeg_start_compress(&j, TRUE);
  for (const Marker& m : markers)
    jpeg_write_marker(&j, m.kind, reinterpret_cast<const JOCTET*>(m.bytes.data()), unsigned(m.bytes.size()));
  std::mt19937 random(unsigned(kind.stored));
  std::vector<JSAMPLE> row(std::size_t(width * j.input_components));
  for (int y = 0; y < height; ++y) {
    for (std::size_t k = 0; k < row.size(); ++k) row[k] = JSAMPLE(k * 5 + std::size_t(y) * 3 + random() % 90);
    JSAMPROW rows = row.data();
    jpeg_write_scanlines(&j, &rows, 1);
  }
  jpeg_finish_compress(&j);
  jpeg_destroy_compress(&j);
  std::string file(reinterpret_cast<char*>(bytes), size);
  std::free(bytes);
  return file;
}

constexpr Kind plain{JCS_RGB, JCS_YCbCr, 2, 2};

ImageReader read_by_openimageio(const std::string& file) { return formats().open("jpeg", "a.jpg", file, false, false); }

std::string text_of(const ImageFacts& facts, const char* name) {
  const auto found = facts.attributes.find(name);
  return found == facts.attributes.end() ? "none" : found->second;
}

void expect_same_words(const ImageFacts& is, const ImageFacts& wanted) {
  expect_same_facts(is, wanted);
  EXPECT_EQ(is.orientation, wanted.orientation);
  EXPECT_EQ(text_of(is, description), text_of(wanted, description));
  EXPECT_EQ(text_of(is, copyright), text_of(wanted, copyright));
}

TEST(Jpeg, AllKindsAreReadAsOpenImageIoReadsThem) {
  std::vector<Kind> kinds;
  for (const bool progressive : {false, true})
    for (const bool arithmetic : {false, true}) {
      kinds.push_back({JCS_GRAYSCALE, JCS_GRAYSCALE, 1, 1, progressive, arithmetic});
      for (const J_COLOR_SPACE stored : {JCS_RGB, JCS_YCbCr})
        kinds.push_back({JCS_RGB, stored, 1, 1, progressive, arithmetic});
      for (const J_COLOR_SPACE stored : {JCS_CMYK, JCS_YCCK})
        kinds.push_back({JCS_CMYK, stored, 1, 1, progressive, arithmetic});
      for (const int across : {1, 2, 4})
        for (const int down : {1, 2}) kinds.push_back({JCS_RGB, JCS_YCbCr, across, down, progressive, arithmetic});
    }
  for (const Kind& kind : kinds)
    for (const auto& [width, height] : {std::pair(37, 21), std::pair(1, 1), std::pair(7, 3)}) {
      SCOPED_TRACE(fmt::format("{} {}x{} {} {}", int(kind.stored), kind.horizontal, kind.vertical, kind.progressive,
                               kind.arithmetic));
      const std::string bytes = jpeg_file(kind, width, height);
      const InputFile file{std::span<const char>(bytes)};
      const ImageReader reader = open_jpeg(file).value();
      const ImageReader judge = openimageio_judges ? read_by_openimageio(bytes) : open_jpeg(file).value();
      expect_same_words(reader.facts, judge.facts);
      EXPECT_EQ(texels(reader), texels(judge));
      if (height < 21) continue;
      const int last = int(reader.facts.channels.size()) - 1;
      EXPECT_EQ(texels(reader, 15, 18, last, 1), texels(judge, 15, 18, last, 1)) << "rows go back";
      EXPECT_EQ(texels(reader, 20, 21, 0, 1), texels(judge, 20, 21, 0, 1)) << "rows are passed over";
    }
}

// A directory of three entries: orientation, a description of 11 bytes behind the directory, and a copyright of 4 in
// its entry.
std::string exif(bool little, int orientation) {
  const auto number = [little](unsigned n, int size) {
    std::string bytes;
    for (int k = 0; k < size; ++k) bytes += char(n >> unsigned(8 * (little ? k : size - 1 - k)));
    return bytes;
  };
  const auto entry = [&](unsigned tag, unsigned type, unsigned count) {
    return number(tag, 2) + number(type, 2) + number(count, 4);
  };
  return std::string("Exif\0\0", 6) + (little ? "II" : "MM") + number(42, 2) + number(8, 4) + number(3, 2) +
         entry(0x10e, 2, 11) + number(50, 4) + entry(0x112, 3, 1) + number(unsigned(orientation), 2) + number(0, 2) +
         entry(0x8298, 2, 4) + std::string("(c)\0", 4) + number(0, 4) + std::string("some words\0", 11);
}

// Of a file with markers, the same facts as OpenImageIO's.
ImageFacts facts_with(const std::vector<Marker>& markers) {
  const std::string bytes = jpeg_file(plain, 8, 8, markers);
  const InputFile file{std::span<const char>(bytes)};
  const ImageReader reader = open_jpeg(file).value();
  expect_same_words(reader.facts, read_by_openimageio(bytes).facts);
  return reader.facts;
}

TEST(Jpeg, ExifAndCommentsTellWhatOpenImageIoFinds) {
  for (const bool little : {false, true})
    for (int way = 0; way < 10; ++way) {
      const ImageFacts facts = facts_with({{JPEG_APP0 + 1, exif(little, way)}});
      EXPECT_EQ(int(facts.orientation), way < 1 || way > 8 ? 1 : way);
      EXPECT_EQ(text_of(facts, description), "some words");
      EXPECT_EQ(text_of(facts, copyright), "(c)");
    }
  EXPECT_EQ(text_of(facts_with({{JPEG_COM, "one"}, {JPEG_COM, "two"}}), description), "one");
  EXPECT_EQ(text_of(facts_with({{JPEG_COM, "one"}, {JPEG_APP0 + 1, exif(true, 1)}}), description), "one");
  EXPECT_EQ(text_of(facts_with({{JPEG_APP0 + 1, exif(true, 1)}, {JPEG_COM, "one"}}), description), "some words");
}

TEST(Jpeg, CutExifIsPassedOver) {
  const std::string whole = exif(true, 6);
  for (std::size_t size = 0; size < whole.size(); ++size) {
    const std::string bytes = jpeg_file(plain, 8, 8, {{JPEG_APP0 + 1, whole.substr(0, size)}});
    const InputFile file{std::span<const char>(bytes)};
    EXPECT_EQ(int(open_jpeg(file).value().facts.orientation), size < 40 ? 1 : 6) << size;
  }
}

TEST(Jpeg, XmpAndIptcThatTellMoreAreLeftToOpenImageIo) {
  const std::string mark("http://ns.adobe.com/xap/1.0/\0", 29), iptc(
                                                                    "Photoshop 3.0\0"
                                                                    "8BIM\4\4\0\0\0\0\0\7",
                                                                    26);
  const auto is_read = [](const std::vector<Marker>& markers) {
    const std::string bytes = jpeg_file(plain, 8, 8, markers);
    const InputFile file{std::span<const char>(bytes)};
    return open_jpeg(file).has_value();
  };
  const auto xmp_is_read = [&](const char* text) { return is_read({{JPEG_APP0 + 1, mark + text}}); };
  EXPECT_TRUE(xmp_is_read("<rdf:Description GPano:ProjectionType='equirectangular'/>"));
  EXPECT_FALSE(xmp_is_read("<rdf:Description tiff:Orientation='3'/>"));
  EXPECT_FALSE(xmp_is_read("<dc:description>words</dc:description>"));
  EXPECT_FALSE(xmp_is_read("<dc:rights>mine</dc:rights>"));
  EXPECT_FALSE(xmp_is_read("<rdf:Description envmap:projection='cube'/>"));
  const Marker caption{JPEG_APP0 + 13, iptc + std::string("\x1c\x02\x78\0\2ab", 7)};
  const Marker headline{JPEG_APP0 + 13, iptc + std::string("\x1c\x02\x69\0\2ab", 7)};
  EXPECT_TRUE(is_read({headline}));
  EXPECT_FALSE(is_read({caption}));
  EXPECT_TRUE(is_read({{JPEG_COM, "words"}, caption})) << "a description is there already";
  EXPECT_THROW(is_read({{JPEG_APP0 + 2, std::string("urn:iso:std:iso:ts:21496:-1\0\0\0\0\0", 32)}}), InputError)
      << "a gain map that is not there";
  EXPECT_TRUE(is_read({{JPEG_APP0 + 2, "ICC_PROFILE"}}));
}

TEST(Jpeg, CutImagesAreRefused) {
  for (const bool progressive : {false, true}) {
    const std::string whole = jpeg_file({JCS_RGB, JCS_YCbCr, 2, 2, progressive});
    for (std::size_t size = 0; size < whole.size(); size += 3) {
      const InputFile file{std::span(whole).first(size)};
      EXPECT_THROW(texels(open_jpeg(file).value()), InputError) << size;
    }
  }
}

// Each byte of the file changed: refused or read, as the place has it.
TEST(Jpeg, ChangedImagesAreReadOrRefused) {
  const std::string whole = jpeg_file({JCS_CMYK, JCS_YCCK, 1, 1, true}, 9, 9);
  int refused = 0;
  for (std::size_t at = 0; at < whole.size(); ++at) {
    std::string odd = whole;
    odd[at] = char(odd[at] ^ 0x41);
    const InputFile file{std::span<const char>(odd)};
    try {
      const auto reader = open_jpeg(file);
      if (reader && reader->facts.height < 100) (void)texels(*reader);
    } catch (const InputError& e) {
      EXPECT_EQ(std::string(e.what()).find('\n'), std::string::npos);
      ++refused;
    }
  }
  EXPECT_GT(refused, int(whole.size()) / 4);
}

// As many scans as a grey image can have: one for each bit of each coefficient.
TEST(Jpeg, HundredsOfScansAreRefused) {
  Kind kind{JCS_GRAYSCALE, JCS_GRAYSCALE};
  kind.scans.push_back({1, {0}, 0, 0, 0, 0});
  for (int coefficient = 1; coefficient < DCTSIZE2; ++coefficient)
    for (int bit = 9; bit >= 0; --bit)
      kind.scans.push_back({1, {0}, coefficient, coefficient, bit == 9 ? 0 : bit + 1, bit});
  const auto message = [&] {
    const std::string bytes = jpeg_file(kind, 8, 8);
    const InputFile file{std::span<const char>(bytes)};
    try {
      (void)texels(open_jpeg(file).value());
    } catch (const InputError& e) {
      return std::string(e.what());
    }
    return std::string();
  };
  EXPECT_EQ(message(), "it has more than 500 scans");
  kind.scans.resize(500);
  EXPECT_EQ(message(), "");
}

}  // namespace
}  // namespace envmap::jpeg_test
