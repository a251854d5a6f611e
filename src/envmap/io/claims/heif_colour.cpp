#include "envmap/io/claims/heif_colour.h"

#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <string_view>

#include "envmap/base/error.h"
#include "envmap/io/claims/code_points.h"
#include "envmap/io/claims/module_colour.h"

namespace envmap {
namespace {

unsigned two_bytes(std::string_view bytes, std::size_t at) {
  return unsigned{static_cast<unsigned char>(bytes[at])} << 8U | static_cast<unsigned char>(bytes[at + 1]);
}

// Kinds of items that hold a gain map: of the standard, and of Apple.
void check_gain_map(std::string_view head, std::optional<double> headroom, ImageFacts& facts) {
  for (const std::string_view kind : {"tmap", "urn:com:apple:photo:2020:aux:hdrgainmap"}) {
    if (head.find(kind) == head.npos) continue;
    if (!headroom || *headroom > 0)
      throw InputError(fmt::format("not supported: a gain map ({}) in HEIF or AVIF", kind), Remedy::take_base);
    facts.claims.push_back({"gain map", std::string(kind), Claim::Outcome::overridden});
  }
}

}  // namespace

void read_heif_colours(const InputFile& file, std::optional<double> headroom, ImageFacts& facts) {
  std::string head(std::min<std::uint64_t>(file.size(), 1 << 16), '\0');
  head.resize(file.pread(head.data(), head.size(), 0));
  constexpr std::string_view box = "colrnclx";
  check_gain_map(head, headroom, facts);
  const std::size_t profile = std::min(head.find("colrprof"), head.find("colrrICC"));
  const bool has_profile = profile != head.npos && profile >= 4;
  if (has_profile) {
    const std::size_t size = std::size_t{two_bytes(head, profile - 4)} << 16U | two_bytes(head, profile - 2);
    facts.icc_profile = profile_at(file, profile + 8, std::uint64_t{size} - 12);
  }
  std::optional<CodePoints> found;
  for (std::size_t at = head.find(box); at != head.npos && at + box.size() + 6 < head.size();
       at = head.find(box, at + 1)) {
    // What is decoded has all of its 8 bits.
    const CodePoints points{two_bytes(head, at + box.size()), two_bytes(head, at + box.size() + 2)};
    if (!points.is_specified()) continue;
    if (found && (found->primaries != points.primaries || found->transfer != points.transfer))
      throw InputError(fmt::format("not supported: images of {} and of {} in one file", words(*found), words(points)),
                       Remedy::choose_space);
    found = points;
  }
  if (!found) return;
  Claim claim{.name = "nclx", .value = words(*found), .of_colour = true};
  if (has_profile)
    claim.outcome = Claim::Outcome::ignored, claim.reason = "the ICC profile comes first";
  else
    facts.colour = colour_of(*found, "nclx");
  facts.claims.push_back(claim);
}

}  // namespace envmap
