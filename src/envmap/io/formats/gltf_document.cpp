#include "envmap/io/formats/gltf_document.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>

#include "envmap/base/error.h"

namespace envmap {

static_assert(std::endian::native == std::endian::little, "glTF's buffers are little-endian");

// ---- fields ---------------------------------------------------------------------------------------------------------

void Field::fail(const std::string& why) const {
  throw InputError((place_.empty() ? "the document" : place_) + " " + why);
}

Field Field::operator[](const char* key) const {
  const std::string place = place_ + (place_.empty() ? "" : ".") + key;
  if (!there()) return {nullptr, place};
  if (!value_->is_object()) fail("is no object");
  const auto found = value_->find(key);
  return {found == value_->end() ? nullptr : &*found, place};
}

Field Field::operator[](std::size_t element) const {
  return {&(*value_)[element], fmt::format("{}[{}]", place_, element)};
}

std::size_t Field::size() const {
  if (!there()) return 0;
  if (!value_->is_array()) fail("is no array");
  return value_->size();
}

double Field::number() const {
  if (!there()) fail("is missing");
  if (!value_->is_number()) fail("is no number");
  const auto number = value_->get<double>();
  if (std::abs(number) > std::numeric_limits<float>::max()) fail("is beyond float32");
  return number;
}

double Field::number(double otherwise, double least, double most) const {
  const double found = number(otherwise);
  if (found < least || found > most) fail(fmt::format("is {}, not from {} to {}", found, least, most));
  return found;
}

std::size_t Field::index(std::size_t end) const {
  const double found = number();
  if (found < 0 || found != std::floor(found)) fail(fmt::format("is {}, no whole number from 0", found));
  if (found >= double(end)) fail(fmt::format("is {}, but there are {}", found, end));
  return std::size_t(found);
}

std::string Field::text(const std::string& otherwise) const {
  if (!there()) return otherwise;
  if (!value_->is_string()) fail("is no text");
  return value_->get<std::string>();
}

bool Field::truth(bool otherwise) const {
  if (!there()) return otherwise;
  if (!value_->is_boolean()) fail("is neither true nor false");
  return value_->get<bool>();
}

std::vector<double> Field::numbers(std::vector<double> otherwise) const {
  if (!there()) return otherwise;
  if (size() != otherwise.size()) fail(fmt::format("holds {} values, not {}", size(), otherwise.size()));
  for (std::size_t k = 0; k < otherwise.size(); ++k) otherwise[k] = (*this)[k].number();
  return otherwise;
}

std::vector<double> Field::numbers(std::vector<double> otherwise, double least, double most) const {
  std::vector<double> found = numbers(std::move(otherwise));
  for (std::size_t k = 0; k < size(); ++k) found[k] = (*this)[k].number(0, least, most);
  return found;
}

Field GltfDocument::refer(const Field& index, const char* list) const {
  const Field all = root()[list];
  return all[index.index(all.size())];
}

// ---- bytes ----------------------------------------------------------------------------------------------------------

namespace {

std::vector<std::byte> from_base64(std::string_view text, const Field& where) {
  std::vector<std::byte> bytes;
  bytes.reserve(text.size() / 4 * 3);
  std::uint32_t bits = 0;
  int held = 0;
  while (text.ends_with('=')) text.remove_suffix(1);
  static constexpr std::string_view digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  static const auto values = [] {
    std::array<int, 256> table;
    table.fill(-1);
    for (std::size_t k = 0; k < digits.size(); ++k) table[static_cast<unsigned char>(digits[k])] = int(k);
    return table;
  }();
  for (const char c : text) {
    const int value = values[static_cast<unsigned char>(c)];
    if (value < 0) where.fail("is not Base64");
    bits = bits << 6 | std::uint32_t(value);
    held += 6;
    if (held < 8) continue;
    held -= 8;
    bytes.push_back(static_cast<std::byte>(bits >> held));
  }
  return bytes;
}

std::string without_percents(const std::string& uri) {
  std::string plain;
  const auto digit = [](char c) { return c <= '9' ? c - '0' : (c | 32) - 'a' + 10; };
  for (std::size_t k = 0; k < uri.size(); ++k) {
    const bool coded = uri[k] == '%' && k + 2 < uri.size() && std::isxdigit(static_cast<unsigned char>(uri[k + 1])) &&
                       std::isxdigit(static_cast<unsigned char>(uri[k + 2]));
    plain += coded ? static_cast<char>(16 * digit(uri[k + 1]) + digit(uri[k + 2])) : uri[k];
    if (coded) k += 2;
  }
  return plain;
}

std::uint32_t word(std::span<const std::byte> bytes, std::size_t at) {
  std::uint32_t value;
  std::memcpy(&value, bytes.data() + at, sizeof value);
  return value;
}

constexpr std::uint32_t json_chunk = 0x4e4f534a, bin_chunk = 0x004e4942;

struct Chunks {
  std::string_view json;
  std::optional<std::span<const std::byte>> bin;
};

// GLB: a header of 12 bytes, then chunks of length, kind and bytes (specification, section 4).
Chunks chunks_of(std::span<const std::byte> file) {
  const auto text = [](std::span<const std::byte> s) {
    return std::string_view(reinterpret_cast<const char*>(s.data()), s.size());
  };
  if (!text(file).starts_with("glTF")) return {text(file), std::nullopt};
  if (file.size() < 20) throw InputError("truncated: a GLB file has at least 20 bytes");
  if (word(file, 4) != 2) throw InputError(fmt::format("is GLB version {}; only 2 is read", word(file, 4)));
  if (word(file, 8) > file.size())
    throw InputError(fmt::format("truncated: {} of {} bytes are there", file.size(), word(file, 8)));
  file = file.first(word(file, 8));
  Chunks found;
  for (std::size_t at = 12; at + 8 <= file.size();) {
    const std::size_t length = word(file, at);
    if (length > file.size() - at - 8) throw InputError("damaged: a chunk is longer than the file");
    const auto chunk = file.subspan(at + 8, length);
    if (at == 12 && word(file, at + 4) != json_chunk) throw InputError("damaged: the first chunk is not JSON");
    if (at == 12)
      found.json = text(chunk);
    else if (word(file, at + 4) == bin_chunk && !found.bin)
      found.bin = chunk;
    at += 8 + length;
  }
  return found;
}

}  // namespace

Resource bytes_at(const GltfDocument& document, const Field& uri) {
  const std::string text = uri.text();
  if (text.starts_with("data:")) {
    const std::size_t comma = text.find(";base64,");
    if (comma == std::string::npos) uri.fail("is a data URI without base64");
    return {from_base64(std::string_view(text).substr(comma + 8), uri), ""};
  }
  if (text.empty() || text.find("://") != std::string::npos) uri.fail("names no file beside the scene");
  try {
    const auto path = document.folder.file(without_percents(text));
    return {file_bytes(path), path.string()};
  } catch (const MissingFile&) {
    throw MissingFile(uri.place() + " names '" + text + "', which is missing: put it into the scene's folder");
  } catch (const InputError& e) {
    uri.fail("names '" + text + "': " + e.what());
  }
}

GltfDocument parse_gltf(std::span<const std::byte> file, const SceneFolder& folder,
                        std::optional<std::span<const std::byte>>& bin) {
  const Chunks chunks = chunks_of(file);
  bin = chunks.bin;
  GltfDocument document{folder};
  try {
    document.json = nlohmann::json::parse(chunks.json);
  } catch (const nlohmann::json::parse_error& e) {
    throw InputError(fmt::format("not sound JSON at byte {}", e.byte));
  } catch (const nlohmann::json::out_of_range&) {
    throw InputError("not sound JSON: a number is too large");
  }
  const std::string version = document.root()["asset"]["version"].text();
  if (!version.starts_with("2.")) throw InputError("not glTF 2.0: asset.version is '" + version + "'");
  return document;
}

GltfDocument open_gltf(std::span<const std::byte> file, const SceneFolder& folder) {
  std::optional<std::span<const std::byte>> bin;
  GltfDocument document = parse_gltf(file, folder, bin);
  load_buffers(document, bin);
  return document;
}

void load_buffers(GltfDocument& document, const std::optional<std::span<const std::byte>>& bin) {
  const Field buffers = document.root()["buffers"];
  for (std::size_t k = 0; k < buffers.size(); ++k) {
    const Field buffer = buffers[k], uri = buffer["uri"];
    const auto length = buffer["byteLength"].index(std::numeric_limits<std::uint32_t>::max());
    if (uri.there()) {
      Resource read;
      try {
        read = bytes_at(document, uri);
      } catch (const MissingFile& e) {
        throw InputError(e.what());  // No scene can do without its numbers.
      }
      document.buffers.push_back(std::move(read.bytes));
      if (!read.file.empty()) document.files.push_back(read.file);
    } else if (k == 0 && bin) {
      document.buffers.emplace_back(bin->begin(), bin->end());
    } else {
      buffer.fail("has neither an URI nor a chunk in the file");
    }
    if (document.buffers[k].size() < length)
      buffer.fail(fmt::format("ends early: {} of {} bytes are there", document.buffers[k].size(), length));
    document.buffers[k].resize(length);
  }
}

// ---- accessors ------------------------------------------------------------------------------------------------------

namespace {

std::size_t bytes_of_component(const Field& type) {
  switch (type.index(65536)) {
    case 5120:
    case 5121: return 1;
    case 5122:
    case 5123: return 2;
    case 5125:
    case 5126: return 4;
    default: type.fail("is no component type");
  }
}

int components_of(const Field& type) {
  constexpr std::pair<const char*, int> known[] = {{"SCALAR", 1}, {"VEC2", 2}, {"VEC3", 3}, {"VEC4", 4},
                                                   {"MAT2", 4},   {"MAT3", 9}, {"MAT4", 16}};
  const std::string text = type.text();
  for (const auto& [name, components] : known)
    if (text == name) return components;
  type.fail("is '" + text + "', no type of an accessor");
}

// `count` elements of `size` bytes from a view and an offset into it; the field `where` is to blame.
std::span<const std::byte> elements(std::span<const std::byte> view, std::size_t offset, std::size_t count,
                                    std::size_t size, std::size_t stride, const Field& where) {
  if (offset > view.size() ||
      (count > 0 && (count - 1 > view.size() / stride || (count - 1) * stride + size > view.size() - offset)))
    where.fail("reaches beyond its buffer view");
  return view.subspan(offset);
}

double component(const std::byte* at, int type, bool normalized) {
  const auto as = [&]<class T>(T value, double scale) {
    std::memcpy(&value, at, sizeof value);
    return normalized ? std::max(double(value) / scale, -1.0) : double(value);
  };
  switch (type) {
    case 5120: return as(std::int8_t{}, 127);
    case 5121: return as(std::uint8_t{}, 255);
    case 5122: return as(std::int16_t{}, 32767);
    case 5123: return as(std::uint16_t{}, 65535);
    case 5125: return as(std::uint32_t{}, 4294967295.0);
    default: return as(float{}, 1);
  }
}

// Elements that a sparse accessor has in other places. @param place puts an element, from its bytes, there.
template <class Place>
void place_sparse(const GltfDocument& document, const Field& accessor, std::size_t all, std::size_t element,
                  const Place& place) {
  const Field sparse = accessor["sparse"], indices = sparse["indices"], values = sparse["values"];
  const std::size_t count = sparse["count"].index(all + 1), narrow = bytes_of_component(indices["componentType"]);
  const auto list = [&](const Field& part, std::size_t size) {
    const auto bytes = view_bytes(document, part["bufferView"]);
    return elements(bytes, part["byteOffset"].index(bytes.size() + 1, 0), count, size, size, part);
  };
  const auto places = list(indices, narrow), with = list(values, element);
  const int type = int(indices["componentType"].number());
  for (std::size_t k = 0; k < count; ++k) {
    const double at = component(places.data() + k * narrow, type, false);
    if (!(at >= 0) || at >= double(all)) indices.fail(fmt::format("holds {}, but there are {}", at, all));
    place(std::size_t(at), with.data() + k * element);
  }
}

}  // namespace

std::span<const std::byte> view_bytes(const GltfDocument& document, const Field& index) {
  const Field view = document.refer(index, "bufferViews");
  const std::span<const std::byte> buffer = document.buffers[view["buffer"].index(document.buffers.size())];
  const std::size_t offset = view["byteOffset"].index(buffer.size() + 1, 0);
  return buffer.subspan(offset, view["byteLength"].index(buffer.size() - offset + 1));
}

Accessor open_accessor(const GltfDocument& document, const Field& index) {
  const Field field = document.refer(index, "accessors"), view = field["bufferView"];
  Accessor a;
  const std::size_t size = bytes_of_component(field["componentType"]);
  a.type = int(field["componentType"].number());
  a.components = components_of(field["type"]);
  a.normalized = field["normalized"].truth(false);
  a.sparse = field["sparse"].there();
  // Without a view all is zero, and nothing in the file bounds how much: more than this nobody means.
  constexpr std::size_t most = std::size_t{1} << 31, max_zeros = std::size_t{1} << 20;
  a.count = field["count"].index(view.there() ? most : max_zeros);
  const std::size_t element = size * std::size_t(a.components);
  a.stride = element;
  if (!view.there()) return a;
  const Field stride = document.refer(view, "bufferViews")["byteStride"];
  a.stride = stride.index(253, element);
  if (a.stride < element) stride.fail("is less than an element");
  const auto bytes = view_bytes(document, view);
  a.bytes = elements(bytes, field["byteOffset"].index(bytes.size() + 1, 0), a.count, element, a.stride, field);
  return a;
}

std::vector<double> accessor_numbers(const GltfDocument& document, const Field& index, int components) {
  const Accessor a = open_accessor(document, index);
  const Field field = document.refer(index, "accessors");
  if (a.components != components) field.fail(fmt::format("has {} components, not {}", a.components, components));
  const auto wide = std::size_t(components);
  const std::size_t size = bytes_of_component(field["componentType"]);
  std::vector<double> numbers(a.count * wide);
  const auto place = [&](std::size_t element, const std::byte* from) {
    for (std::size_t c = 0; c < wide; ++c)
      numbers[element * wide + c] = component(from + c * size, a.type, a.normalized);
  };
  if (!a.bytes.empty())
    for (std::size_t k = 0; k < a.count; ++k) place(k, a.bytes.data() + k * a.stride);
  if (a.sparse) place_sparse(document, field, a.count, size * wide, place);
  if (!std::ranges::all_of(numbers, [](double x) { return std::isfinite(x); }))
    field.fail("holds NaN or infinite numbers");
  return numbers;
}

}  // namespace envmap
