#include "maps/shard_options.h"

#include <fmt/format.h>

#include <bit>
#include <cstdint>
#include <cstring>
#include <set>

#include "cli/command_line.h"
#include "envmap/base/error.h"
#include "envmap/base/parallel.h"

namespace tools {
namespace {

using namespace envmap;

// Fowler, Noll and Vo's hash FNV-1a (RFC 9923), of four bytes at a time.
constexpr std::uint64_t offset_basis = 0xcbf29ce484222325, prime = 0x100000001b3;

std::uint64_t hash(std::uint64_t sum, std::uint32_t value) { return (sum ^ value) * prime; }

std::uint64_t hash(std::uint64_t sum, std::string_view text) {
  for (const char c : text) sum = hash(sum, static_cast<unsigned char>(c));
  return hash(sum, 0U);
}

std::uint64_t hash_row(std::span<const Colour> row) {
  std::uint64_t sum = offset_basis;
  for (const Colour& c : row)
    for (const float value : {c.x, c.y, c.z}) sum = hash(sum, std::bit_cast<std::uint32_t>(value));
  return sum;
}

// Options that change no byte of the whole, or are another for each part.
bool counts(const std::string& option) {
  static const std::set<std::string> none{"--shard",   "--threads", "--quiet",      "--verbose", "--json",
                                          "--depfile", "--fsync",   "--if-changed", "--force",   "--max-memory"};
  return !none.contains(option);
}

std::string job(const Shard& shard, const std::string& source) {
  std::uint64_t sum = hash(hash(hash(offset_basis, version_text()), shard.command), source);
  for (const Option& option : shard.options->rows) {
    if (option.given.empty() || option.is_argument() || !counts(option.name)) continue;
    sum = hash(sum, option.name);
    for (const std::string& word : option.given) sum = hash(sum, word);
  }
  return fmt::format("{:016x}", sum);
}

std::optional<PartNumber> part_number(const std::string& text) {
  const std::vector<std::string> numbers = split(text, '/');
  PartNumber part{};
  if (numbers.size() != 2 || !parse_number(numbers[0], part.index) || !parse_number(numbers[1], part.count))
    return std::nullopt;
  return part.index >= 1 && part.index <= part.count && part.count <= 65536 ? std::optional(part) : std::nullopt;
}

}  // namespace

void add_shard(Options& o, std::string_view command, Shard& shard) {
  shard.command = command, shard.options = &o;
  o.group = groups::builds;
  o.add(
      "--shard", "I/N",
      [&shard](const std::string& text) {
        shard.part = part_number(text);
        if (!shard.part) throw std::invalid_argument(fmt::format("'{}' is not I/N, with I from 1 to N", text));
        return true;
      },
      "Compute part I of N ('envmap merge' joins the parts to the same bytes)");
}

std::string digest(const EnvironmentMap& source) {
  std::uint64_t sum = hash(offset_basis, name(source.projection()));
  sum = hash(sum, std::uint32_t(source.forward));
  for (const Level& level : source.levels) {
    sum = hash(hash(sum, std::uint32_t(level.width())), std::uint32_t(level.height()));
    const auto rows = map_level<std::uint64_t>(level, [&](std::uint64_t& found, int face, int j) {
      found = hash_row(level.row(face, j));
    });
    for (const std::uint64_t row : rows) sum = hash(hash(sum, std::uint32_t(row)), std::uint32_t(row >> 32));
  }
  return fmt::format("{:016x}", sum);
}

WriteOptions part_or_whole(const Shard& shard, const WriteOptions& whole, Projection projection,
                           std::span<const int> sizes, const std::string& source) {
  if (!shard.part) return whole;
  if (out_of_working(whole.colour).apply)
    throw UsageError("--shard: parts hold linear values: choose a linear --output-space");
  return part_options(whole, projection, sizes, *shard.part, job(shard, source));
}

WriteOptions part_or_whole(const Shard& shard, const WriteOptions& whole, const Rows& rows, const std::string& source) {
  return part_or_whole(shard, whole, rows.projection, std::span(&rows.size, 1), source);
}

void leave_mirror_to_merge(WriteOptions& part, MirroredAxis mirror) {
  if (mirror != MirroredAxis::none) part.facts["whole-mirror"] = mirrored_axis_names[std::size_t(mirror)];
}

}  // namespace tools
