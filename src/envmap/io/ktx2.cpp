#include <fmt/format.h>
#include <zstd.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <memory>
#include <numeric>

#include "envmap/base/error.h"
#include "envmap/base/parallel.h"
#include "envmap/io/bands.h"
#include "envmap/io/containers.h"
#include "envmap/io/key_values.h"
#include "envmap/io/write_plan.h"

namespace envmap {
namespace {

// Section 3, "File Structure": what comes first in a file.
struct Header {
  std::array<char, 12> identifier;
  std::uint32_t vk_format, type_size, width, height, depth, layers, faces, levels, scheme;
  std::uint32_t dfd_offset, dfd_size, kvd_offset, kvd_size;
  std::uint64_t sgd_offset, sgd_size;
};
static_assert(sizeof(Header) == 80);

struct LevelIndex {
  std::uint64_t offset, size, plain_size;
};

enum Scheme : std::uint32_t { plain = 0, zstandard = 2 };

// ---- data format descriptor -----------------------------------------------------------------------------------------

using Words = std::vector<std::uint32_t>;

// A sample of a basic descriptor block: which bits hold a channel, and what the least and largest of them mean.
void add_sample(Words& words, unsigned offset, unsigned length, unsigned channel_type, std::uint32_t lower,
                std::uint32_t upper) {
  words.insert(words.end(), {offset | (length - 1) << 16 | channel_type << 24, 0, lower, upper});
}

// Texel by texel or, of BC6H, block by block. E5B9G9R9's limits are those of the Data Format
// Specification 1.4, table 105: the shared exponent counts for each channel.
Words descriptor(const TexelFormat& format, KhrColour colour) {
  constexpr unsigned is_float = 0x80, is_signed = 0x40, is_exponent = 0x20, alpha = 15;
  constexpr std::uint32_t one = 0x3f800000, minus_one = 0xbf800000;  // As floats.
  constexpr std::uint32_t rgbsda = 1, bc6h = 133;
  const std::uint32_t model = format.depth == Depth::bc6h ? bc6h : rgbsda, side = std::uint32_t(format.side) - 1;
  const std::uint32_t primaries = colour.primaries, transfer = colour.transfer;
  Words words{0, 0, 0, model | primaries << 8 | transfer << 16, side | side << 8, std::uint32_t(format.bytes), 0};
  if (model == bc6h) {
    const bool is_negative = format.texels == Texels::bc6h_sfloat;
    add_sample(words, 0, 128, is_float | (is_negative ? is_signed : 0), is_negative ? minus_one : 0, one);
  } else if (format.texels == Texels::rgb9e5) {
    for (unsigned c = 0; c < 3; ++c) {
      add_sample(words, 9 * c, 9, c, 0, 8448);
      add_sample(words, 27, 5, c | is_exponent, 15, 31);
    }
  } else {
    const auto channels = unsigned(format.channels), bits = unsigned(8 * format.bytes) / channels;
    for (unsigned c = 0; c < channels; ++c)
      add_sample(words, c * bits, bits, (c == 3 ? alpha : c) | is_float | is_signed, minus_one, one);
  }
  const auto size = std::uint32_t(4 * words.size());
  words[0] = size;
  words[2] = 2 | (size - 4) << 16;  // Version 1.3 and later; size of the block.
  return words;
}

// Bytes 13 and 14 of the descriptor behind its size; of a descriptor that is cut nothing.
KhrColour described_colour(const InputFile& file, const Header& h) {
  if (h.dfd_size < 16 || std::uint64_t{h.dfd_offset} + h.dfd_size > file.size()) return {};
  const auto word = read_as<std::uint32_t>(file, h.dfd_offset + 12U);
  return {std::uint8_t(word >> 8), std::uint8_t(word >> 16)};
}

// ---- levels ---------------------------------------------------------------------------------------------------------

// Texels on their way to the file, through Zstandard where that is asked for. One worker gives the bytes that any
// number of workers gives; none would give others.
class LevelWriter {
 public:
  LevelWriter(OutputFile& file, bool zstd) : file_(file), context_(zstd ? ZSTD_createCCtx() : nullptr, ZSTD_freeCCtx) {
    if (!zstd) return;
    if (!context_) throw std::bad_alloc();
    ZSTD_CCtx_setParameter(context_.get(), ZSTD_c_nbWorkers, std::max(1, thread_limit()));
    packed_.resize(ZSTD_CStreamOutSize());
  }

  void begin(std::uint64_t size) {
    if (context_) ZSTD_CCtx_setPledgedSrcSize(context_.get(), size);
  }
  void write(std::span<const std::byte> bytes) {
    if (context_)
      compress(bytes, ZSTD_e_continue);
    else
      file_.put(bytes.data(), bytes.size());
  }
  void end() {
    if (context_) compress({}, ZSTD_e_end);
  }

 private:
  void compress(std::span<const std::byte> bytes, ZSTD_EndDirective directive) {
    ZSTD_inBuffer in{bytes.data(), bytes.size(), 0};
    for (bool more = true; more;) {
      ZSTD_outBuffer out{packed_.data(), packed_.size(), 0};
      const std::size_t left = ZSTD_compressStream2(context_.get(), &out, &in, directive);
      if (ZSTD_isError(left)) throw OutputError(fmt::format("not compressed: {}", ZSTD_getErrorName(left)));
      file_.put(packed_.data(), out.pos);
      more = directive == ZSTD_e_end ? left > 0 : in.pos < in.size;
    }
  }

  OutputFile& file_;
  std::unique_ptr<ZSTD_CCtx, decltype(&ZSTD_freeCCtx)> context_;
  std::vector<char> packed_;
};

std::vector<std::byte> decompressed(std::span<const std::byte> packed, std::uint64_t size) {
  const auto fail = [](const std::string& why) { throw InputError("damaged: a level does not decompress: " + why); };
  if (const auto promised = ZSTD_getFrameContentSize(packed.data(), packed.size());
      promised == ZSTD_CONTENTSIZE_ERROR || (promised != ZSTD_CONTENTSIZE_UNKNOWN && promised > size))
    fail("not one Zstandard frame of its size");
  std::vector<std::byte> bytes(size);
  const std::size_t found = ZSTD_decompress(bytes.data(), bytes.size(), packed.data(), packed.size());
  if (ZSTD_isError(found)) fail(ZSTD_getErrorName(found));
  if (found != size) fail("it is too short");
  return bytes;
}

}  // namespace

void write_ktx2(OutputFile& file, std::span<const Atlas> levels, const TexturePlan& plan, const Progress& progress) {
  const TexelFormat& format = format_of(plan.texels);
  const Words dfd = descriptor(format, plan.colour);
  KeyValues pairs = key_values(plan.data, plan.pairs);
  pairs.emplace("KTXorientation", "rd");
  const std::string kvd = key_value_bytes(pairs);
  Header h{};
  std::ranges::copy(ktx2_mark, h.identifier.begin());
  h.vk_format = format.vulkan;
  h.type_size = format.type_size;
  h.width = std::uint32_t(levels[0].width());
  h.height = plan.cube ? h.width : std::uint32_t(levels[0].height());
  h.faces = plan.cube ? 6 : 1;
  h.levels = std::uint32_t(levels.size());
  h.scheme = plan.zstd ? zstandard : plain;
  h.dfd_offset = std::uint32_t(sizeof(Header) + levels.size() * sizeof(LevelIndex));
  h.dfd_size = std::uint32_t(4 * dfd.size());
  h.kvd_offset = h.dfd_offset + h.dfd_size;
  h.kvd_size = std::uint32_t(kvd.size());

  Shares shares(progress, levels);
  std::vector<LevelIndex> index(levels.size());
  LevelWriter out(file, plan.zstd);
  file.seek(h.kvd_offset + h.kvd_size);
  for (std::size_t k = levels.size(); k-- > 0;) {
    const std::vector<Atlas> images = images_of(levels[k], plan.cube);
    const auto align = plan.zstd ? 1 : std::lcm(std::int64_t(format.bytes), std::int64_t{4});
    file.seek((file.tell() + align - 1) / align * align);
    index[k].offset = std::uint64_t(file.tell());
    index[k].plain_size = images.size() * format.image_bytes(images[0].width(), images[0].height());
    out.begin(index[k].plain_size);
    encode_images(format, images, shares, [&](std::span<const std::byte> rows) { out.write(rows); });
    out.end();
    index[k].size = std::uint64_t(file.tell()) - index[k].offset;
  }
  file.seek(0);
  file.put(&h, sizeof h);
  file.put(index.data(), index.size() * sizeof(LevelIndex));
  file.put(dfd.data(), h.dfd_size);
  file.put(kvd.data(), kvd.size());
}

TextureFile open_ktx2(const InputFile& file) {
  const auto h = read_as<Header>(file, 0);
  const auto* format = std::ranges::find(texel_formats, h.vk_format, &TexelFormat::vulkan);
  if (format == std::end(texel_formats))
    throw InputError(
        fmt::format("not supported: KTX2 with VkFormat {}: only RGB as bytes, floats, E5B9G9R9 or BC6H is read",
                    h.vk_format));
  if (h.scheme != plain && h.scheme != zstandard)
    throw InputError(
        fmt::format("not supported: KTX2 with supercompression {}: only none and Zstandard are read", h.scheme));
  if (h.depth != 0 || h.layers > 1 || (h.faces != 1 && h.faces != 6))
    throw InputError(
        fmt::format("not supported: KTX2 of depth {}, {} layers and {} faces: one flat image or one cube map is read",
                    h.depth, h.layers, h.faces));
  constexpr std::uint32_t most = 0x7fffffff;
  TextureFile t{.container = "ktx2",
                .texels = format->texels,
                .width = int(std::min(h.width, most)),
                .height = int(std::min(h.height, most)),
                .levels = int(std::clamp(h.levels, 1U, most)),
                .cube = h.faces == 6};
  check_texture(t, file.size());
  KeyValues pairs;
  if (h.kvd_size > 0) pairs = parse_key_values(read_bytes(file, h.kvd_offset, h.kvd_size));
  if (const std::string& o = pairs["KTXorientation"]; !o.empty()) {
    t.bottom_up = o == "ru";
    if (o != "rd" && (o != "ru" || t.cube))
      throw InputError(
          fmt::format("not supported: KTX2 of orientation '{}': 'rd' is read, and 'ru' of flat images", o));
  }
  t.recorded = recorded(pairs);
  t.colour = described_colour(file, h);

  std::vector<LevelIndex> index;
  for (int k = 0; k < t.levels; ++k) {
    index.push_back(read_as<LevelIndex>(file, sizeof(Header) + std::size_t(k) * sizeof(LevelIndex)));
    const std::uint64_t wanted = (t.cube ? 6 : 1) * t.image_bytes(k);
    if (index.back().plain_size != wanted || (h.scheme == plain && index.back().size != wanted))
      throw InputError(fmt::format("damaged: level {} has {} bytes, not {}", k, index.back().plain_size, wanted));
  }
  t.bytes = [index, scheme = h.scheme](const InputFile& from, int level) {
    const LevelIndex& at = index[std::size_t(level)];
    std::vector<std::byte> bytes = read_bytes(from, at.offset, at.size);
    return scheme == plain ? bytes : decompressed(bytes, at.plain_size);
  };
  return t;
}

}  // namespace envmap
