// Damaged files are refused; whatever their bytes, the program ends by itself.
#include <filesystem>
#include <ostream>
#include <random>

#include "picture.h"
#include "run.h"

namespace command_tests::damage_test {
namespace {

using OIIO::TypeDesc;

struct Kind {
  const char* name;
  const char* file;
  TypeDesc::BASETYPE type = TypeDesc::FLOAT;
  const char* compression = nullptr;
};

// What ctest shows as the parameter.
void PrintTo(const Kind& kind, std::ostream* out) { *out << kind.name; }

class Damage : public CommandTest, public ::testing::WithParamInterface<Kind> {
 protected:
  std::string sound() const {
    OIIO::ImageSpec spec;
    if (GetParam().compression) spec.attribute("compression", GetParam().compression);
    save(path(GetParam().file), latlong_directions(16), GetParam().type, spec);
    return read(GetParam().file);
  }
};

// In the signature, in the pixels, near the end: the last few bytes of a PNG hold nothing that would be missed.
TEST_P(Damage, CutFilesAreRefused) {
  const std::string whole = sound();
  succeeds({"info", GetParam().file});
  const std::string name = std::string("cut") + std::filesystem::path(GetParam().file).extension().string();
  for (const std::size_t length : {std::size_t{11}, whole.size() * 2 / 3, whole.size() - 40}) {
    SCOPED_TRACE(length);
    write(name, whole.substr(0, length));
    fails(3, {"info", name}, {name});
  }
}

// One to three changes of the kinds that upset readers; half of them in the header. The engine alone is the same
// everywhere; the standard's distributions are not.
std::string mutated(std::string bytes, unsigned seed) {
  std::mt19937 random(seed);
  const auto below = [&](std::size_t n) { return std::size_t(random()) % n; };
  constexpr unsigned char extremes[] = {0x00, 0x01, 0x7f, 0x80, 0xff};
  for (std::size_t changes = 1 + below(3); changes > 0 && bytes.size() > 8; --changes) {
    const std::size_t reach = below(2) == 0 ? std::min<std::size_t>(bytes.size(), 360) : bytes.size();
    const std::size_t at = below(reach - 4);
    switch (below(7)) {
      case 0: bytes[at] = static_cast<char>(bytes[at] ^ (1 << below(8))); break;
      case 1: bytes[at] = static_cast<char>(extremes[below(5)]); break;
      case 2: bytes[at] = static_cast<char>(random()); break;
      case 3: bytes.replace(at, 4, 4, static_cast<char>(extremes[below(5)])); break;
      case 4: bytes.resize(at + 4); break;
      case 5: bytes.erase(at, 1 + below(16)); break;
      default: bytes.insert(at, bytes.substr(below(bytes.size()), 1 + below(16)));
    }
  }
  return bytes;
}

class DamagedTiff : public CommandTest {
 protected:
  // A little-endian TIFF file's entry: tag, type, count, value, here one 32-bit number.
  static void set_tag(std::string& tiff, unsigned tag, std::uint32_t value) {
    const auto number = [&](std::size_t at, int bytes) {
      std::uint32_t n = 0;
      for (int k = bytes; k-- > 0;) n = n << 8 | static_cast<unsigned char>(tiff.at(at + std::size_t(k)));
      return n;
    };
    const std::size_t directory = number(4, 4);
    for (std::size_t at = directory + 2, end = at + 12 * number(directory, 2); at < end; at += 12) {
      if (number(at, 2) != tag) continue;
      const std::uint32_t words[] = {tag | 4U << 16, 1, value};
      for (std::size_t k = 0; k < 12; ++k) tiff.at(at + k) = static_cast<char>(words[k / 4] >> 8 * (k % 4));
      return;
    }
    FAIL() << "no tag " << tag;
  }
};

// OpenImageIO takes memory for a tile, or divides by its sides, whatever they are.
TEST_F(DamagedTiff, TilesOfAbsurdSizeAreRefused) {
  OIIO::ImageSpec spec;
  spec.tile_width = spec.tile_height = 16;
  save(path("map.tif"), latlong_directions(16), TypeDesc::FLOAT, spec);
  succeeds({"info", "map.tif"});
  for (const unsigned side : {322U, 323U})  // TileWidth, TileLength.
    for (const std::uint32_t length : {1U << 24, 0x7ffffff0U, 0xffffffffU})
      for (const unsigned orientation : {1U, 3U}) {  // Upright, and turned by half.
        SCOPED_TRACE(testing::Message() << side << ' ' << length << ' ' << orientation);
        std::string bytes = read("map.tif");
        set_tag(bytes, side, length);
        set_tag(bytes, 274, orientation);
        write("tiles.tif", bytes);
        fails(3, {"info", "tiles.tif"}, {"tiles.tif"}, {.memory = std::uint64_t{4} << 30});
      }
}

// Where a run misbehaves its file is kept for whoever looks into it.
std::string kept(const std::string& from) {
  const auto folder = std::filesystem::temp_directory_path() / "envmap-damaged";
  std::filesystem::create_directories(folder);
  const auto to = folder / std::filesystem::path(from).filename();
  std::filesystem::copy_file(from, to, std::filesystem::copy_options::overwrite_existing);
  return to.string();
}

TEST_P(Damage, ChangedBytesNeverEndTheProgramByASignal) {
  constexpr unsigned runs = 12;  // Each start of the program costs a fifth of a second; tests/fuzz goes further.
  const std::string whole = sound();
  for (unsigned seed = 1; seed <= runs; ++seed) {
    const std::string name = std::string(GetParam().name) + "_" + std::to_string(seed) +
                             std::filesystem::path(GetParam().file).extension().string();
    write(name, mutated(whole, seed));
    const Result r = envmap({"info", name, "--threads", "2"}, {.memory = std::uint64_t{4} << 30});
    if (r.status != 0 && r.status != 3)
      ADD_FAILURE() << "status " << r.status << ", signal " << r.signal << ": " << r.err << kept(path(name));
  }
}

// Textures of this project's own readers, as the program writes them; `compression` is an option.
class DamagedTexture : public CommandTest, public ::testing::WithParamInterface<Kind> {
 protected:
  std::string sound() const {
    succeeds({"generate", "directions", "in.exr", "--to", "cube", "--size", "8"});
    std::vector<std::string> arguments{"mipmap", "in.exr", GetParam().file};
    if (GetParam().compression) arguments.emplace_back(GetParam().compression);
    succeeds(arguments);
    return read(GetParam().file);
  }
};

TEST_P(DamagedTexture, CutAnywhereIsRefused) {
  const std::string whole = sound();
  for (const std::size_t length :
       {std::size_t{11}, std::size_t{90}, std::size_t{140}, whole.size() / 2, whole.size() - 1}) {
    SCOPED_TRACE(length);
    write("cut", whole.substr(0, length));
    fails(3, {"info", "cut", "--levels"}, {"cut"});
  }
}

// Words of the header at their extreme: sizes, counts and offsets that no file can hold.
TEST_F(CommandTest, TextureHeadersThatPromiseTooMuchAreRefused) {
  succeeds({"generate", "directions", "in.exr", "--to", "cube", "--size", "8"});
  const auto refuse = [&](const std::string& name, std::initializer_list<std::size_t> words) {
    succeeds({"mipmap", "in.exr", name});
    const std::string whole = read(name);
    for (const std::size_t at : words) {
      SCOPED_TRACE(testing::Message() << name << " at " << at);
      std::string bytes = whole;
      bytes.replace(at, 4, 4, '\xff');
      write("bad", bytes);
      fails(3, {"info", "bad"}, {"bad"}, {.memory = std::uint64_t{4} << 30});
    }
  };
  // Format, width, height, depth, layers, faces, levels, scheme, key/value offset and length;
  // offset and lengths of level 0.
  refuse("map.ktx2", {12, 20, 24, 28, 32, 36, 40, 44, 56, 60, 80, 88, 96});
  // Byte order, type, formats, width, height, depth, elements, faces, levels, length of the pairs and of the first.
  refuse("map.ktx", {12, 16, 24, 28, 36, 40, 44, 48, 52, 56, 60, 64});
  // Height, width, levels; format, dimension, array size.
  refuse("map.dds", {12, 16, 28, 128, 132, 140});
}

INSTANTIATE_TEST_SUITE_P(Formats, DamagedTexture,
                         ::testing::Values(Kind{"ktx2", "map.ktx2"},
                                           Kind{"ktx2_zstd", "map.ktx2", TypeDesc::FLOAT, "--zstd"},
                                           Kind{"ktx", "map.ktx"}, Kind{"dds", "map.dds"}, Kind{"env", "map.env"}),
                         [](const auto& test) { return std::string(test.param.name); });

constexpr Kind kinds[] = {{"exr_half_zip", "map.exr", TypeDesc::HALF, "zip"},
                          {"exr_float_piz", "map.exr", TypeDesc::FLOAT, "piz"},
                          {"hdr", "map.hdr"},
                          {"pfm", "map.pfm"},
                          {"png_8", "map.png", TypeDesc::UINT8},
                          {"png_16", "map.png", TypeDesc::UINT16},
                          {"tiff_float_zip", "map.tif", TypeDesc::FLOAT, "zip"},
                          {"tiff_8_lzw", "map.tif", TypeDesc::UINT8, "lzw"}};

INSTANTIATE_TEST_SUITE_P(Formats, Damage, ::testing::ValuesIn(kinds),
                         [](const auto& test) { return std::string(test.param.name); });

// As numbers in JSON they may be anything; .env files say so where a face lies, .glb files which it is.
TEST_F(CommandTest, NumbersOfJsonThatAreNoOffsetsAreRefused) {
  succeeds({"generate", "sky", "sky.exr", "--to", "cube", "--size", "2", "-q"});
  succeeds({"mipmap", "sky.exr", "sky.env"});
  const std::string sound = read("sky.env"), zero = "\"position\":0";
  for (const std::string number : {"-1", "0.5", "1e87", "18446744073709551615", "null", "[]"}) {
    std::string odd = sound;
    odd.replace(odd.find(zero), zero.size(), "\"position\":" + number);
    write("odd.env", odd);
    fails(3, {"info", "odd.env"}, {"odd.env", "damaged"});
  }
  std::string also = sound;
  also.replace(also.find(zero), zero.size(), "\"position\":0.0");
  write("also.env", also);
  EXPECT_EQ(envmap({"info", "also.env"}).status, 0);
}

}  // namespace
}  // namespace command_tests::damage_test
