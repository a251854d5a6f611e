#include "envmap/io/formats/key_values.h"

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <string_view>

#include "envmap/base/error.h"

namespace envmap {
namespace {

constexpr std::string_view prefix = "envmap:";

}  // namespace

KeyValues key_values(const Metadata& data, const KeyValues& more) {
  KeyValues pairs = more;
  pairs.emplace("KTXwriter", "envmap");
  for (const auto& [name, text] : facts(data)) pairs.emplace(std::string(prefix) + name, text);
  return pairs;
}

std::string key_value_bytes(const KeyValues& pairs) {
  std::string bytes;
  for (const auto& [key, value] : pairs) {
    const std::string pair = key + '\0' + value + '\0';
    const auto size = std::uint32_t(pair.size());
    bytes.append(reinterpret_cast<const char*>(&size), sizeof size).append(pair);
    bytes.append((4 - bytes.size() % 4) % 4, '\0');
  }
  return bytes;
}

KeyValues parse_key_values(std::span<const std::byte> bytes) {
  KeyValues pairs;
  const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  for (std::size_t at = 0; at + 4 <= text.size();) {
    std::uint32_t size = 0;
    std::memcpy(&size, text.data() + at, sizeof size);
    if (size > text.size() - at - 4) throw InputError("damaged: a key/value pair reaches beyond its section");
    const std::string_view pair = text.substr(at + 4, size), key = pair.substr(0, pair.find('\0'));
    std::string_view value = pair.substr(std::min(pair.size(), key.size() + 1));
    if (value.ends_with('\0')) value.remove_suffix(1);
    pairs.emplace(key, value);
    at += 4 + (std::size_t(size) + 3) / 4 * 4;
  }
  return pairs;
}

Metadata recorded(const KeyValues& pairs) {
  Facts facts;
  for (const auto& [key, value] : pairs)
    if (key.starts_with(prefix) && is_word(key.substr(prefix.size())) && is_word(value))
      facts.emplace(key.substr(prefix.size()), value);
  return metadata(std::move(facts));
}

}  // namespace envmap
