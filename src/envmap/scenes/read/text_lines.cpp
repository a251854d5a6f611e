#include "envmap/scenes/read/text_lines.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>

#include "envmap/base/error.h"

namespace envmap {
namespace {

constexpr std::string_view space = " \t\r\v\f";

std::string_view trimmed(std::string_view text) {
  const std::size_t begin = text.find_first_not_of(space);
  return begin == text.npos ? "" : text.substr(begin, text.find_last_not_of(space) - begin + 1);
}

}  // namespace

TextLines::TextLines(std::string_view text) : rest_(text), end_(text.find('\n') == text.npos ? '\r' : '\n') {
  if (rest_.starts_with(byte_order_mark)) rest_.remove_prefix(byte_order_mark.size());
}

bool TextLines::next() {
  if (rest_.empty()) return false;
  number_ = lines_ + 1;
  joined_.clear();
  for (bool on = true; on;) {
    const std::size_t end = rest_.find(end_);
    line_ = trimmed(rest_.substr(0, end));
    rest_.remove_prefix(end == rest_.npos ? rest_.size() : end + 1);
    ++lines_;
    const bool is_comment = joined_.empty() && line_.starts_with('#');
    on = line_.ends_with('\\') && !is_comment && !rest_.empty();
    if (on) line_.remove_suffix(1);
    if (!on && joined_.empty()) return true;
    (joined_ += line_) += ' ';
  }
  line_ = trimmed(joined_);
  return true;
}

std::string_view Words::word() {
  rest_.remove_prefix(std::min(rest_.find_first_not_of(space), rest_.size()));
  if (rest_.starts_with('#')) rest_ = {};
  const std::string_view found = rest_.substr(0, rest_.find_first_of(space));
  rest_.remove_prefix(found.size());
  return found;
}

std::string Words::name() {
  const std::string_view found = trimmed(rest_);
  rest_ = {};
  return std::string(found);
}

float Words::number() {
  const std::string_view found = word();
  if (found.empty()) fail("a number is missing");
  std::string_view digits = found;
  if (digits.starts_with('+')) digits.remove_prefix(1);
  double value = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  // What is below all doubles is 0.
  if (error == std::errc::invalid_argument || end != digits.data() + digits.size())
    fail(quoted(found) + " is no number");
  const auto narrow = float(value);
  const bool too_large = error == std::errc::result_out_of_range && digits.find('-', 1) == digits.npos;
  if (too_large || !std::isfinite(narrow)) fail(quoted(found) + " is NaN, infinite or beyond float32");
  return narrow;
}

void Words::fail(const std::string& why) const { throw InputError(fmt::format("line {}: {}", line_, why)); }

std::string quoted(std::string_view text) {
  constexpr std::size_t most = 60;
  return fmt::format("'{}{}'", text.substr(0, most), text.size() > most ? "..." : "");
}

void check_text(std::string_view bytes) {
  if (bytes.starts_with("\xff\xfe") || bytes.starts_with("\xfe\xff"))
    throw InputError("is UTF-16 text; save it as UTF-8");
  if (bytes.find('\0') != bytes.npos) throw InputError("is not text");
}

}  // namespace envmap
