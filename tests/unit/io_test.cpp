// Files as the library writes them; the program's own tests are in tests/command.
#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfMultiPartOutputFile.h>
#include <ImfOutputFile.h>
#include <ImfOutputPart.h>
#include <ImfPartType.h>
#include <ImfRgbaFile.h>
#include <ImfStandardAttributes.h>
#include <ImfTiledOutputFile.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <unistd.h>

#include <atomic>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <map>

#include "envmap/base/error.h"
#include "envmap/io/claims/srgb.h"
#include "envmap/io/files/output_file.h"
#include "envmap/io/formats/file_format.h"
#include "envmap/io/formats/openimageio_module.h"
#include "envmap/io/images/image_writer.h"
#include "envmap/io/images/picture.h"
#include "envmap/io/read.h"
#include "envmap/io/write.h"
#include "envmap/io/write_table.h"
#include "envmap/operate/generate.h"
#include "envmap/projection/visit.h"

namespace envmap::io_test {
namespace {

namespace fs = std::filesystem;

class Io : public testing::Test {
 protected:
  Io() { fs::create_directories(folder_); }
  ~Io() override { fs::remove_all(folder_); }
  [[nodiscard]] std::string path(const std::string& name) const { return (folder_ / name).string(); }
  [[nodiscard]] std::size_t entries() const { return std::size_t(std::distance(fs::directory_iterator(folder_), {})); }

 private:
  fs::path folder_ = fs::temp_directory_path() / ("envmap_io_" + std::to_string(::getpid()));
};

TEST_F(Io, ErrorsNameTheFileAndWhatWouldHelpInNoWordsOfACommandLine) {
  EnvironmentMap map = generate(Constant{}, Projection::latlong, 8);
  map.base().texel(0, 3, 2)->y = -1;
  write(path("dark.exr"), rows_of(map), {});
  try {
    static_cast<void>(read(path("dark.exr"), {}));
    FAIL();
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ErrorCode::input);
    EXPECT_EQ(e.remedy(), Remedy::repair);
    EXPECT_EQ(e.file(), path("dark.exr"));
    EXPECT_EQ(std::string(e.what()),
              path("dark.exr") + ": 1 of 128 texels are no radiance (1 negative), the first at (3,2)");
  }
  EXPECT_EQ(read(path("dark.exr"), {.flaws = FlawPolicy::repair}).repaired, 1);
  try {
    map.base().texel(0, 3, 2)->y = 1e6F;
    write(path("bright.exr"), rows_of(map), {.depth = Depth::half});
    FAIL();
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ErrorCode::output);
    EXPECT_EQ(e.remedy(), Remedy::clamp_or_deepen);
  }
}

TEST_F(Io, NothingIsLeftWithoutCommit) {
  {
    OutputFile file(path("a.bin"));
    file.write("half", 4);
    EXPECT_FALSE(fs::exists(path("a.bin")));
  }
  EXPECT_EQ(entries(), 0U);
}

TEST_F(Io, CommitReplaces) {
  std::ofstream(path("a.bin")) << "something longer that was there before";
  OutputFile file(path("a.bin"));
  file.write("new", 3);
  file.seek(0);
  file.write("N", 1);
  file.commit();
  std::string text;
  std::getline(std::ifstream(path("a.bin")), text);
  EXPECT_EQ(text, "New");
  EXPECT_EQ(entries(), 1U);
}

// A limit on files is like a full disk. Rows take hours to make: none is made for a file that has failed.
TEST_F(Io, AFullDiskEndsTheWork) {
  for (const std::string name : {"a.exr", "a.hdr", "a.pfm", "a.ktx", "a.ktx2", "a.dds"}) {
    rlimit before = {};
    ASSERT_EQ(::getrlimit(RLIMIT_FSIZE, &before), 0);
    std::signal(SIGXFSZ, SIG_IGN);
    std::atomic<int> made = 0;
    Rows rows{Projection::latlong, 4096, Forward::plus_z, [&](int, int row, std::span<Colour> out) {
                ++made;
                for (std::size_t k = 0; k < out.size(); ++k)
                  out[k] = Colour(float((k * 2654435761U + std::size_t(row) * 40503U) % 1000003U));
              }};
    const rlimit small{1 << 16, before.rlim_max};
    ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &small), 0);
    EXPECT_THROW(write(path(name), rows, {.clamp = true}), OutputError) << name;
    EXPECT_EQ(::setrlimit(RLIMIT_FSIZE, &before), 0);
    EXPECT_LT(made, 1024) << name;
    EXPECT_EQ(entries(), 0U);
  }
}

TEST_F(Io, ReadOnlyFilesAreReplacedByForceAlone) {
  const EnvironmentMap map = generate(Directions{}, Projection::cube, 2);
  write(path("a.exr"), rows_of(map), {});
  fs::permissions(path("a.exr"), fs::perms(0444));
  try {
    write(path("a.exr"), rows_of(map), {});
    FAIL();
  } catch (const OutputError& e) {
    EXPECT_EQ(e.remedy(), Remedy::force);
  }
  write(path("a.exr"), rows_of(map), {.commit = {.force = true}});
  EXPECT_EQ(entries(), 1U);
}

TEST_F(Io, FloatExrIsExact) {
  for (const Projection p : all_projections) {
    const EnvironmentMap map = generate(Directions{}, p, 5);
    write(path("m.exr"), rows_of(map), {});
    const Source back = read(path("m.exr"), {});
    EXPECT_EQ(back.map.projection(), p);
    for (int f = 0; f < faces(p); ++f)
      for (int j = 0; j < 5; ++j)
        EXPECT_TRUE(std::ranges::equal(back.map.base().row(f, j), map.base().row(f, j))) << name(p);
  }
}

// The table of formats against what files do: every extension at every depth comes back as that format and depth, known
// by its bytes, with values as near as the depth has them.
TEST_F(Io, EveryFormatHoldsWhatItsRowSays) {
  const EnvironmentMap map = generate(Directions{}, Projection::latlong, 24);  // 0 to 1, smooth.
  const auto tolerance = [](const FileFormat& format, Depth depth) {
    if (format.name == "jpeg" || format.name == "webp") return 0.1;  // Lossy.
    if (format.name == "hdr") return 0x1p-8;                         // 8 bits beside a shared exponent.
    if (depth == Depth::uint8) return 0.5 / 255 * 2.3;               // The steepest of the sRGB curve.
    if (depth == Depth::uint16) return 0.5 / 65535 * 2.3 + 1e-6;
    if (depth == Depth::bc6h || depth == Depth::uastc_hdr)
      return 0.2;  // Lossy, and 4x4 of these texels span 30 degrees.
    return depth == Depth::half ? 0x1p-12 : depth == Depth::rgb9e5 ? 0x1p-10 : 0.0;
  };
  int tried = 0;
  for (const FileFormat& format : file_formats())
    for (const std::string_view extension : format.extensions)
      for (const Depth depth : format.depths) {
        SCOPED_TRACE(testing::Message() << extension << " " << name(depth));
        const std::string file = path("map." + std::string(extension));
        if (format.cubes_alone) {  // Read back by texture_test.cpp.
          EXPECT_THROW(write(file, rows_of(map), {.depth = depth}), UsageError);
          continue;
        }
        EXPECT_EQ(write(file, rows_of(map), {.depth = depth}).depth, depth);
        if (format.is_head) fs::rename(file, path("unnamed"));  // A name that says nothing.
        const Source back = read(format.is_head ? path("unnamed") : file, {.projection = Projection::latlong});
        EXPECT_EQ(back.depth, depth);
        EXPECT_EQ(back.format, format.name);
        double worst = 0;
        for (int j = 0; j < 24; ++j)
          for (int i = 0; i < 48; ++i) {
            const Colour off = glm::abs(*back.map.base().texel(0, i, j) - *map.base().texel(0, i, j));
            worst = std::max<double>(worst, std::max({off.x, off.y, off.z}));
          }
        EXPECT_LE(worst, tolerance(format, depth));
        ++tried;
      }
  EXPECT_GT(tried, 20);
}

TEST_F(Io, ForwardIsRecorded) {
  const EnvironmentMap map = generate(Directions{}, {Projection::latlong, Forward::minus_x}, 4);
  write(path("m.exr"), rows_of(map), {});
  EXPECT_EQ(read(path("m.exr"), {}).map.forward, Forward::minus_x);
  EXPECT_EQ(read(path("m.exr"), {.forward = Forward::plus_x}).map.forward, Forward::plus_x);
  EXPECT_EQ(read(path("m.exr"), {.assumed_forward = Forward::plus_x}).map.forward, Forward::minus_x);
}

TEST_F(Io, ValuesThatDoNotFitAreRefusedOrClamped) {
  const EnvironmentMap map = generate(Constant{{7e4, 1, 1}}, Projection::latlong, 4);
  WriteOptions half{.depth = Depth::half};
  EXPECT_THROW(write(path("m.exr"), rows_of(map), half), OutputError);
  EXPECT_EQ(entries(), 0U);
  half.clamp = true;
  const Written done = write(path("m.exr"), rows_of(map), half);
  EXPECT_EQ(done.clamped, 4 * 8);
  EXPECT_NEAR(done.flux_lost, (7e4 - 65504) / (7e4 + 2), 1e-9);
}

// OpenEXR's envmap attribute: the first row is the pole itself, first and last column the same meridian.
TEST_F(Io, BorderSamplesAreMovedToCellCentres) {
  const int w = 64, h = 32;
  std::vector<float> pixels;
  for (int j = 0; j < h; ++j)
    for (int i = 0; i < w; ++i) {
      const double longitude = pi - 2 * pi * i / (w - 1), latitude = pi / 2 - pi * j / (h - 1);
      const Direction d{std::cos(latitude) * std::sin(longitude), std::sin(latitude),
                        std::cos(latitude) * std::cos(longitude)};
      for (int c = 0; c < 3; ++c) pixels.push_back(float(0.5 + 0.5 * d[c]));
    }
  Imf::Header header(w, h);
  Imf::addEnvmap(header, Imf::ENVMAP_LATLONG);
  Imf::FrameBuffer frame;
  const char* channels[] = {"R", "G", "B"};
  for (std::size_t c = 0; c < 3; ++c) {
    header.channels().insert(channels[c], Imf::Channel(Imf::FLOAT));
    frame.insert(channels[c], Imf::Slice(Imf::FLOAT, reinterpret_cast<char*>(pixels.data() + c), 3 * sizeof(float),
                                         3 * sizeof(float) * w));
  }
  {
    Imf::OutputFile out(path("m.exr").c_str(), header);
    out.setFrameBuffer(frame);
    out.writePixels(h);
  }

  const auto worst = [](const Level& level) {
    double angle = 0;
    for (int j = 0; j < h; ++j)
      for (int i = 0; i < w; ++i)
        angle = std::max(angle, angle_between(glm::normalize(2.0 * Direction(*level.texel(0, i, j)) - 1.0),
                                              Latlong::direction(0, (i + 0.5) / w, (j + 0.5) / h)));
    return angle * h / pi;  // In texels.
  };
  const Source read_right = read(path("m.exr"), {});
  EXPECT_TRUE(read_right.border_samples);
  EXPECT_LT(worst(read_right.map.base()), 0.01);
  EXPECT_GT(worst(read(path("m.exr"), {.ignore_envmap_attribute = true}).map.base()), 0.4);
}

TEST_F(Io, MoreLevelsThanTheSizeHasAreRefused) {
  EnvironmentMap map;
  for (const int size : {2, 1, 1}) map.levels.emplace_back(Projection::cube, size);
  for (const char* format : {"ktx2", "ktx", "dds", "exr"}) {
    EXPECT_THROW((void)encode(map, {.format = format}), UsageError) << format;
    EXPECT_NO_THROW(write(path("{level}." + std::string(format)), map)) << format;
  }
}

// OpenEXR may round levels up: no texel of a latlong image is left out, and nothing of another size is written.
TEST_F(Io, LevelsThatAreRoundedUpAreRead) {
  const int w = 10, h = 5;
  Imf::Header header(w, h);
  header.setTileDescription(Imf::TileDescription(16, 16, Imf::MIPMAP_LEVELS, Imf::ROUND_UP));
  const std::vector<float> white(w * h, 1);
  Imf::FrameBuffer frame;
  for (const char* channel : {"R", "G", "B"}) {
    header.channels().insert(channel, Imf::Channel(Imf::FLOAT));
    frame.insert(channel, Imf::Slice(Imf::FLOAT, const_cast<char*>(reinterpret_cast<const char*>(white.data())),
                                     sizeof(float), sizeof(float) * w));
  }
  {
    Imf::TiledOutputFile out(path("up.exr").c_str(), header);
    out.setFrameBuffer(frame);
    for (int level = 0; level < out.numLevels(); ++level)
      out.writeTiles(0, out.numXTiles(level) - 1, 0, out.numYTiles(level) - 1, level);
  }
  const Source source = read(path("up.exr"), {.all_levels = true});
  ASSERT_EQ(source.map.levels.size(), 4U);  // 10x5 5x3 3x2 2x1, of which the last would be 1x1 if rounded down.
  EXPECT_EQ(source.map.levels[1].width(), 5);
  EXPECT_EQ(source.map.levels[1].height(), 3);
  for (const Level& level : source.map.levels)
    for (int j = 0; j < level.height(); ++j)
      for (const Colour& c : level.row(0, j)) EXPECT_EQ(c, Colour(1));
  EXPECT_THROW(write(path("out.exr"), all_rows_of(source.map), {}), UsageError);
}

// An image of one value a channel, whose windows begin anywhere.
void write_exr(const std::string& path, const Imath::Box2i& window, const std::map<std::string, Imf::Channel>& channels,
               const std::map<std::string, float>& values, std::optional<Imf::LevelMode> tiles,
               std::optional<Imath::Box2i> display = {}) {
  Imf::Header header(display.value_or(window), window);
  const auto width = std::size_t(window.max.x - window.min.x + 1);
  const auto height = std::size_t(window.max.y - window.min.y + 1);
  std::vector<std::vector<float>> pixels;
  Imf::FrameBuffer frame;
  for (const auto& [name, channel] : channels) {
    header.channels().insert(name, channel);
    pixels.emplace_back(width * height, values.at(name));
    char* origin = reinterpret_cast<char*>(pixels.back().data()) -
                   std::ptrdiff_t(sizeof(float)) * (window.min.x + window.min.y * std::ptrdiff_t(width));
    frame.insert(name, Imf::Slice(channel.type, origin, sizeof(float), sizeof(float) * width, channel.xSampling,
                                  channel.ySampling));
  }
  if (tiles) {
    header.setTileDescription(Imf::TileDescription(4, 4, *tiles));
    Imf::TiledOutputFile out(path.c_str(), header);
    out.setFrameBuffer(frame);
    for (int y = 0; y < out.numYLevels(); ++y)
      for (int x = 0; x < out.numXLevels(); ++x)
        if (out.isValidLevel(x, y)) out.writeTiles(0, out.numXTiles(x) - 1, 0, out.numYTiles(y) - 1, x, y);
  } else {
    Imf::OutputFile out(path.c_str(), header);
    out.setFrameBuffer(frame);
    out.writePixels(window.max.y - window.min.y + 1);
  }
}

// What OpenEXR allows beyond what other tools write: windows that begin anywhere, tiles with and without levels.
TEST_F(Io, ExrWindowsAndTiles) {
  const Imf::Channel single(Imf::FLOAT);
  for (const Imath::V2i& first : {Imath::V2i(0, 0), Imath::V2i(-3, 100), Imath::V2i(7, -20)})
    for (const auto& tiles : {std::optional<Imf::LevelMode>(), std::optional(Imf::ONE_LEVEL),
                              std::optional(Imf::MIPMAP_LEVELS), std::optional(Imf::RIPMAP_LEVELS)}) {
      write_exr(path("m.exr"), {first, first + Imath::V2i(7, 3)}, {{"R", single}, {"G", single}, {"B", single}},
                {{"R", 1}, {"G", 2}, {"B", 3}}, tiles);
      const Source source = read(path("m.exr"), {.all_levels = true});
      EXPECT_EQ(source.levels, tiles == Imf::MIPMAP_LEVELS ? 4 : 1);
      for (const Level& level : source.map.levels)
        for (int j = 0; j < level.height(); ++j)
          for (const Colour& c : level.row(0, j)) EXPECT_EQ(c, Colour(1, 2, 3));
    }
}

TEST_F(Io, ExrChannelsThatAreNoRadiance) {
  const Imf::Channel single(Imf::FLOAT), whole(Imf::UINT), coarse(Imf::FLOAT, 2, 2);
  const Imath::Box2i window({0, 0}, {7, 3});
  const std::map<std::string, float> values{{"R", 1}, {"G", 2}, {"B", 3}, {"Y", 4}};
  write_exr(path("grey.exr"), window, {{"Y", single}}, values, {});
  EXPECT_EQ(*read(path("grey.exr"), {}).map.base().texel(0, 7, 3), Colour(4));
  write_exr(path("small.exr"), window, {{"r", single}, {"g", single}, {"b", single}}, {{"r", 1}, {"g", 2}, {"b", 3}},
            {});
  EXPECT_EQ(*read(path("small.exr"), {}).map.base().texel(0, 7, 3), Colour(1, 2, 3));
  write_exr(path("whole.exr"), window, {{"R", single}, {"G", whole}, {"B", single}}, values, {});
  EXPECT_THROW(read(path("whole.exr"), {}), InputError);
  write_exr(path("coarse.exr"), window, {{"R", single}, {"G", coarse}, {"B", single}}, values, {});
  EXPECT_THROW(read(path("coarse.exr"), {}), InputError);
}

// Of a file with several images the first is read, which is said, or the one that was asked for.
TEST_F(Io, ExrOfSeveralParts) {
  std::vector<Imf::Header> headers;
  const std::vector<float> white(8 * 4, 1), black(8 * 4, 0);
  for (const char* part : {"white", "black"}) {
    Imf::Header header(8, 4);
    header.setName(part);
    header.setType(Imf::SCANLINEIMAGE);
    for (const char* c : {"R", "G", "B"}) header.channels().insert(c, Imf::Channel(Imf::FLOAT));
    headers.push_back(header);
  }
  {
    Imf::MultiPartOutputFile out(path("m.exr").c_str(), headers.data(), 2);
    for (int k = 0; k < 2; ++k) {
      Imf::OutputPart part(out, k);
      Imf::FrameBuffer frame;
      for (const char* c : {"R", "G", "B"})
        frame.insert(c, Imf::Slice(Imf::FLOAT,
                                   const_cast<char*>(reinterpret_cast<const char*>((k ? black : white).data())),
                                   sizeof(float), 8 * sizeof(float)));
      part.setFrameBuffer(frame);
      part.writePixels(4);
    }
  }
  const auto first = [&](const std::string& part) {
    return *read(path("m.exr"), {.choice = {.part = part}}).map.base().texel(0, 0, 0);
  };
  const Source source = read(path("m.exr"), {});
  for (int j = 0; j < 4; ++j)
    for (const Colour& c : source.map.base().row(0, j)) EXPECT_EQ(c, Colour(1));
  ASSERT_EQ(source.notes.size(), 1U);
  EXPECT_NE(source.notes[0].find("(white, black)"), std::string::npos);
  EXPECT_EQ(first("white"), Colour(1));
  EXPECT_EQ(first("0"), Colour(1));
  EXPECT_EQ(first("black"), Colour(0));
  EXPECT_EQ(first("1"), Colour(0));
  EXPECT_TRUE(read(path("m.exr"), {.choice = {.part = "black"}}).notes.empty());
  EXPECT_THROW(first("2"), InputError);
  EXPECT_THROW(first("grey"), InputError);
}

TEST_F(Io, ExrLayersAndChannels) {
  const Imf::Channel single(Imf::FLOAT);
  const Imath::Box2i window({0, 0}, {7, 3});
  const std::map<std::string, float> values{{"a.R", 1},   {"a.G", 2},   {"a.B", 3},   {"a.A", 9},
                                            {"b.c.R", 4}, {"b.c.G", 5}, {"b.c.B", 6}, {"Z", 7}};
  const auto colour = [&](const ImageChoice& choice) {
    return *read(path("m.exr"), {.choice = choice}).map.base().texel(0, 7, 3);
  };
  const auto why = [&](const ImageChoice& choice) -> std::string {
    try {
      colour(choice);
    } catch (const InputError& e) {
      return e.what();
    }
    return "";
  };
  write_exr(path("m.exr"), window, {{"a.R", single}, {"a.G", single}, {"a.B", single}, {"a.A", single}, {"Z", single}},
            values, {});
  EXPECT_EQ(colour({}), Colour(1, 2, 3)) << "the only layer";
  EXPECT_EQ(read(path("m.exr"), {}).notes.size(), 1U);
  write_exr(path("m.exr"), window,
            {{"a.R", single},
             {"a.G", single},
             {"a.B", single},
             {"b.c.R", single},
             {"b.c.G", single},
             {"b.c.B", single},
             {"Z", single}},
            values, {});
  EXPECT_NE(why({}).find("layers (a, b.c)"), std::string::npos) << why({});
  EXPECT_EQ(colour({.layer = "a"}), Colour(1, 2, 3));
  EXPECT_EQ(colour({.layer = "b.c"}), Colour(4, 5, 6));
  EXPECT_NE(why({.layer = "b"}).find("its layers are a, b.c"), std::string::npos);
  EXPECT_EQ(colour({.channels = "b.c.B,a.R,Z"}), Colour(6, 1, 7));
  EXPECT_EQ(colour({.channels = "Z"}), Colour(7));
  EXPECT_NE(why({.channels = "b.c.B,a.R,Y"}).find("no channel 'Y'"), std::string::npos);
  EXPECT_THROW(colour({.channels = "Z,Z"}), UsageError);
  write_exr(path("m.exr"), window, {{"Z", single}}, values, {});
  EXPECT_NE(why({}).find("holds only Z (depth), no radiance"), std::string::npos) << why({});
}

// What a data window leaves out is black; what is beyond the display window is not there.
TEST_F(Io, ExrDataWindowsArePaddedAndCropped) {
  const Imf::Channel single(Imf::FLOAT);
  const std::map<std::string, float> values{{"R", 1}, {"G", 2}, {"B", 3}};
  const Imath::Box2i shown({100, 50}, {107, 53});
  const Imath::Box2i datas[] = {{{102, 51}, {104, 52}},
                                {{90, 40}, {120, 60}},
                                {{90, 52}, {101, 60}},
                                {{200, 200}, {202, 201}}};
  for (const auto& tiles :
       {std::optional<Imf::LevelMode>(), std::optional(Imf::ONE_LEVEL), std::optional(Imf::MIPMAP_LEVELS)})
    for (const Imath::Box2i& data : datas) {
      write_exr(path("m.exr"), data, {{"R", single}, {"G", single}, {"B", single}}, values, tiles, shown);
      const Source source = read(path("m.exr"), {});
      EXPECT_EQ(source.notes.size(), 1U);
      const Level& level = source.map.base();
      ASSERT_EQ(level.height(), 4);
      for (int y = 0; y < 4; ++y)
        for (int x = 0; x < 8; ++x)
          EXPECT_EQ(level.row(0, y)[x], data.intersects(shown.min + Imath::V2i(x, y)) ? Colour(1, 2, 3) : Colour(0));
    }
}

TEST_F(Io, ExrDataWindowsMayBeTheWholeImage) {
  const Imf::Channel single(Imf::FLOAT);
  write_exr(path("m.exr"), {{102, 51}, {109, 54}}, {{"R", single}, {"G", single}, {"B", single}},
            {{"R", 1}, {"G", 2}, {"B", 3}}, {}, Imath::Box2i({0, 0}, {199, 99}));
  const Source source = read(path("m.exr"), {.choice = {.crop = true}});
  EXPECT_EQ(source.notes.size(), 1U);
  ASSERT_EQ(source.map.base().height(), 4);
  EXPECT_EQ(*source.map.base().texel(0, 7, 3), Colour(1, 2, 3));
}

// OpenEXR's own writer halves the chroma and rounds luminance to 7 bits, chroma to 6: steps of 1/64 of the largest.
TEST_F(Io, ExrLuminanceAndChroma) {
  {
    Imf::RgbaOutputFile out(path("m.exr").c_str(), Imf::Header(8, 4), Imf::WRITE_YC);
    const std::vector<Imf::Rgba> pixels(32, Imf::Rgba(4, 2, 0.5F));
    out.setFrameBuffer(pixels.data(), 1, 8);
    out.writePixels(4);
  }
  const Source source = read(path("m.exr"), {});
  for (int y = 0; y < 4; ++y)
    for (const Colour& c : source.map.base().row(0, y))
      for (int k = 0; k < 3; ++k) EXPECT_NEAR(c[k], Colour(4, 2, 0.5F)[k], 4.0 / 64);
}

// A header can promise anything, and OpenEXR takes the memory first: here there is none to take.
// Rows of a Radiance file may go up and to the left. Its reader says so, and whoever reads sees them upright.
TEST_F(Io, RadianceFilesAreTurnedUpright) {
  const auto texel = [](int number) { return std::string(3, static_cast<char>(20 * number)) + '\x80'; };
  const auto written = [&](const std::string& resolution, const std::vector<int>& numbers) {
    std::string bytes = "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n" + resolution + "\n";
    for (const int number : numbers) bytes += texel(number);
    std::ofstream(path("turned.hdr"), std::ios::binary) << bytes;
    return read(path("turned.hdr"), {.projection = Projection::latlong}).map;
  };
  const EnvironmentMap upright = written("-Y 2 +X 4", {1, 2, 3, 4, 5, 6, 7, 8});
  EXPECT_NE(upright.base().texel(0, 0, 0)->x, upright.base().texel(0, 0, 1)->x);
  for (const auto& [resolution, numbers] : {std::pair("+Y 2 +X 4", std::vector{5, 6, 7, 8, 1, 2, 3, 4}),
                                            std::pair("-Y 2 -X 4", std::vector{4, 3, 2, 1, 8, 7, 6, 5}),
                                            std::pair("+X 4 -Y 2", std::vector{1, 5, 2, 6, 3, 7, 4, 8})}) {
    const EnvironmentMap turned = written(resolution, numbers);
    for (int j = 0; j < 2; ++j)
      for (int i = 0; i < 4; ++i)
        EXPECT_EQ(turned.base().texel(0, i, j)->x, upright.base().texel(0, i, j)->x)
            << resolution << ' ' << i << ' ' << j;
  }
  std::ofstream(path("no.hdr")) << "#?RADIANCE\nFORMAT=no\n\n-Y 2 +X 4\n";
  try {
    static_cast<void>(read(path("no.hdr")));
    FAIL();
  } catch (const InputError& e) {
    EXPECT_NE(std::string(e.what()).find("not an image that can be read: neither FORMAT"), std::string::npos)
        << e.what();
  }
}

// What a row says a format can do is done, and the rest is refused.
TEST_F(Io, FormatsDoWhatTheirRowsSay) {
  const EnvironmentMap map = generate(Constant{Rgb<double>(0.5)}, Projection::latlong, 8);
  const std::vector<Colour> texels(64, Colour(0.5F));
  const auto taken = [](auto&& action) {
    try {
      action();
      return true;
    } catch (const UsageError&) {
      return false;
    }
  };
  for (const FileFormat& format : file_formats())
    for (const std::string_view extension : format.extensions) {
      if (format.cubes_alone) continue;
      SCOPED_TRACE(extension);
      const std::string file = path("row." + std::string(extension));
      const auto writes = [&](const WriteOptions& options) {
        return taken([&] { write(file, rows_of(map), options); });
      };
      EXPECT_EQ(writes({.compression = "zip"}), format.can(FileFormat::compression));
      EXPECT_EQ(writes({.openexr_envmap = true}), format.can(FileFormat::envmap_mark));
      EXPECT_EQ(writes({.rows = {{2, 4}}}), format.can(FileFormat::row_range));
      EXPECT_EQ(writes({.zstd = true}), format.can(FileFormat::zstd));
      write(file, rows_of(map), {});
      const auto reads = [&](const ImageChoice& choice) {
        return taken([&] { static_cast<void>(read(file, {.choice = choice})); });
      };
      EXPECT_EQ(reads({.part = "0"}), format.can(FileFormat::parts));
      EXPECT_EQ(reads({.crop = true}), format.can(FileFormat::window));
      EXPECT_EQ(is_picture(file), format.can(FileFormat::picture));
      if (is_picture(file)) {
        EXPECT_TRUE(taken([&] { write_picture(file, 8, texels); }));
      }
      EXPECT_EQ(taken([&] { write_table(file, texels, 8, "ggx"); }), format.can(FileFormat::table));
    }
  EXPECT_TRUE(taken([&] { write_table(path("row.EXR"), texels, 8, "ggx"); }));  // As maps: capitals are no matter.
  EXPECT_TRUE(is_picture(path("row.PNG")));
}

// A disk with less room than that is refused before anything is written: it must never be too much.
TEST_F(Io, FilesHaveTheBytesThatTheirRowsPromise) {
  const EnvironmentMap black = generate(Constant{Rgb<double>(0)}, Projection::latlong, 256);
  for (const FileFormat& format : file_formats())
    for (const Depth depth : format.depths) {
      if (format.cubes_alone || format.least_bytes == nullptr) continue;
      for (const char* compression : {"", "none", "zip:9", "dwaa", "piz"})
        for (const bool zstd : {false, true}) {
          if ((*compression && !format.can(FileFormat::compression)) || (zstd && !format.can(FileFormat::zstd)))
            continue;
          const WriteOptions options{.depth = depth, .compression = compression, .zstd = zstd};
          const std::string file = path("black." + std::string(format.extensions.front()));
          write(file, rows_of(black), options);
          EXPECT_GE(double(fs::file_size(file)), 256 * 512 * format.least_bytes(depth, options))
              << format.title << ' ' << name(depth) << ' ' << compression;
        }
    }
}

TEST_F(Io, ExrsThatPromiseMoreThanTheyHold) {
  const Imf::Channel single(Imf::FLOAT);
  write_exr(path("m.exr"), {{0, 0}, {7, 3}}, {{"R", single}, {"G", single}, {"B", single}},
            {{"R", 1}, {"G", 1}, {"B", 1}}, Imf::MIPMAP_LEVELS);
  std::ifstream stream(path("m.exr"), std::ios::binary);
  std::string whole{std::istreambuf_iterator<char>(stream), {}};
  const auto why = [&](const std::string& attribute, std::size_t from,
                       std::vector<std::int32_t> values) -> std::string {
    std::string bytes = whole;
    bytes.replace(bytes.find(attribute) + from, 4 * values.size(), reinterpret_cast<const char*>(values.data()),
                  4 * values.size());
    std::ofstream(path("lie.exr"), std::ios::binary) << bytes;
    try {
      read(path("lie.exr"), {});
    } catch (const InputError& e) {
      return e.what();
    }
    return "";
  };
  // Names and types end in 0, then comes the size.
  const std::size_t window = std::string("dataWindow").size() + 1 + std::string("box2i").size() + 1,
                    tiles = std::string("tiles").size() + 1 + std::string("tiledesc").size() + 1;
  EXPECT_NE(why("dataWindow", window + 4, {0, 0, 99999, 49999}).find("cannot hold 100000x50000"), std::string::npos);
  EXPECT_NE(why("dataWindow", window + 4, {0, 0, 4999999, 0}).find("cannot hold 5000000x1"), std::string::npos);
  EXPECT_NE(why("dataWindow", window + 4, {0, 0, 4095, 2047}).find("chunks"), std::string::npos);
  EXPECT_NE(why("dataWindow", window + 4, {0, 0, -4, 2047}).find("empty"), std::string::npos);
  EXPECT_NE(why("dataWindow", window, {2000000000}).find("attribute of 2000000000 bytes"), std::string::npos);
  EXPECT_NE(why("dataWindow", window, {-1}).find("attribute"), std::string::npos);
  EXPECT_NE(why("tiles", tiles + 4, {0, 0}).find("tiles without a size"), std::string::npos);
  // OpenEXR goes by the type and finds the next attribute elsewhere than its header says.
  const std::size_t channels = std::string("channels").size() + 1 + std::string("chlist").size() + 1;
  for (const int size : {54, 56})  // Of 55: three names of a letter, their ends, 16 bytes for each, and the last end.
    EXPECT_NE(why("channels", channels, {size}).find("of type chlist has"), std::string::npos) << size;
  EXPECT_NE(why("dataWindow", window, {17}).find("of type box2i has 17 bytes"), std::string::npos);
  // Beyond the image, whether that is all of the display window or a part.
  EXPECT_NE(why("tiles", tiles + 4, {64, 1 << 22}).find("tiles of 64x4194304"), std::string::npos);
  whole[whole.find("displayWindow") + std::string("displayWindow").size() + window - std::string("dataWindow").size() +
        12] = 15;
  EXPECT_NE(why("tiles", tiles + 4, {64, 1 << 22}).find("tiles of 64x4194304"), std::string::npos);
}

// Half rounds by 2^-11 of a value; below 2^-14 it has only multiples of 2^-24.
// What loses more light than that is refused.
TEST_F(Io, LightThatBecomesNothingIsRefused) {
  const auto loss = [&](float radiance, Depth depth, const std::string& name) {
    const EnvironmentMap map = generate(Constant{Direction(radiance)}, Projection::latlong, 4);
    const auto refused = [&] {
      try {
        write(path(name), rows_of(map), {.depth = depth});
      } catch (const OutputError& e) {
        EXPECT_NE(std::string(e.what()).find("too dark"), std::string::npos) << e.what();
        return true;
      }
      return false;
    };
    const bool no = refused();
    const double lost = write(path(name), rows_of(map), {.depth = depth, .clamp = true}).flux_lost;
    EXPECT_EQ(no, lost > 0) << radiance;
    return lost;
  };
  EXPECT_DOUBLE_EQ(loss(1e-9F, Depth::half, "a.exr"), 1);
  EXPECT_DOUBLE_EQ(loss(1e-9F, Depth::half, "a.ktx2"), 1);
  EXPECT_DOUBLE_EQ(loss(1e-9F, Depth::rgb9e5, "a.ktx2"), 1);
  EXPECT_NEAR(loss(0x1.8p-24F, Depth::half, "a.exr"), 1.0 / 3, 1e-6) << "1.5 becomes 2";
  EXPECT_EQ(loss(0x1.8p-23F, Depth::half, "a.exr"), 0) << "3 stays 3";
  EXPECT_EQ(loss(1e-9F, Depth::single, "a.exr"), 0);
  // Among light the same is nothing.
  EnvironmentMap map = generate(Constant{}, Projection::latlong, 4);
  map.levels[0].row(0, 1)[3] = Colour(1e-9F);
  EXPECT_EQ(write(path("a.exr"), rows_of(map), {.depth = Depth::half}).clamped, 0);
}

// libjpeg would end the program with 1 there.
TEST_F(Io, JpegsThatAreTooLongAreRefused) {
  OutputFile file(path("a.jpg"));
  EXPECT_THROW(formats().create(file, "jpg", {.levels = {{65501, 1}}, .depth = Depth::uint8}), OutputError);
}

// Read by OpenImageIO, which is another reader.
TEST_F(Io, PngKeepsTexelsAndTextsInAnyLanguage) {
  const std::vector<Colour> row{{0, 0.5F, 1}, {2, -1, 0.25F}};
  for (const Depth depth : {Depth::uint8, Depth::uint16}) {
    OutputFile file;
    const ImageWriter writer =
        make_writer(file, "a.png", "png",
                    {.levels = {{2, 1}}, .depth = depth, .attributes = {{description, "a=1"}, {"Artist", "Jürgen"}}});
    writer.write(0, 0, 1, row);
    writer.close();
    const std::vector<std::byte> bytes = file.bytes();
    const ImageReader reader =
        formats().open("png", "a.png", {reinterpret_cast<const char*>(bytes.data()), bytes.size()}, false, false);
    EXPECT_EQ(reader.facts.depth, depth);
    EXPECT_EQ(reader.facts.attributes.at(description), "a=1");
    EXPECT_EQ(reader.facts.attributes.at("Artist"), "Jürgen");
    std::vector<float> texels(6);
    reader.read(0, 0, 1, 0, 3, texels);
    const float wanted[] = {0, 0.5F, 1, 1, 0, 0.25F};
    for (std::size_t k = 0; k < 6; ++k) EXPECT_NEAR(texels[k], wanted[k], depth == Depth::uint8 ? 0.51 / 255 : 1e-5);
  }
}

TEST(Srgb, CurveOfTheStandard) {
  std::vector<Colour> c{{0, 0.04045F, 0.5F}, {1, 0.2F, 0.001F}};
  decode_srgb(c);
  EXPECT_NEAR(c[0].y, 0.04045 / 12.92, 1e-6);
  EXPECT_NEAR(c[0].z, std::pow((0.5 + 0.055) / 1.055, 2.4), 1e-6);
  EXPECT_NEAR(c[1].x, 1, 1e-6);
  encode_srgb(c);
  EXPECT_NEAR(c[0].z, 0.5, 1e-6);
  EXPECT_NEAR(c[1].z, 0.001, 1e-7);
}

}  // namespace
}  // namespace envmap::io_test
