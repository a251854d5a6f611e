/// @file
/// A glTF 2.0 file, its JSON and its buffers, and what is needed to trust them. Source: Khronos, "glTF 2.0
/// Specification"
/// 2.0.1. Everything here throws InputError, without the name of the file, where the file breaks it.
#pragma once

#include <fmt/format.h>

#include <cstddef>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "envmap/io/files/scene_folder.h"

namespace envmap {

/// A value of the document that knows its place, so that what is wrong with it can be said. May be absent.
class Field {
 public:
  Field(const nlohmann::json* value, std::string place) : value_(value), place_(std::move(place)) {}

  [[nodiscard]] bool there() const { return value_ != nullptr; }
  [[nodiscard]] Field operator[](const char* key) const;  ///< Absent where there is none.
  [[nodiscard]] Field operator[](std::size_t element) const;
  [[nodiscard]] std::size_t size() const;  ///< Of an array; 0 where it is absent.

  [[nodiscard]] double number() const;
  [[nodiscard]] double number(double otherwise) const { return there() ? number() : otherwise; }
  [[nodiscard]] double number(double otherwise, double least, double most) const;
  /// A whole number from 0 to end - 1.
  [[nodiscard]] std::size_t index(std::size_t end) const;
  [[nodiscard]] std::size_t index(std::size_t end, std::size_t otherwise) const {
    return there() ? index(end) : otherwise;
  }
  [[nodiscard]] std::string text(const std::string& otherwise = {}) const;
  [[nodiscard]] bool truth(bool otherwise) const;
  /// An array of so many numbers; `otherwise` where it is absent.
  [[nodiscard]] std::vector<double> numbers(std::vector<double> otherwise) const;
  /// The same, each from `least` to `most`.
  [[nodiscard]] std::vector<double> numbers(std::vector<double> otherwise, double least, double most) const;

  [[nodiscard]] const std::string& place() const { return place_; }
  [[noreturn]] void fail(const std::string& why) const;

 private:
  const nlohmann::json* value_;
  std::string place_;
};

/// Numbers of the same shape in a buffer, known to lie inside it.
struct Accessor {
  std::size_t count = 0;
  int components = 1;
  int type = 0;  ///< 5120 int8, 5121 uint8, 5122 int16, 5123 uint16, 5125 uint32, 5126 float.
  bool normalized = false;
  bool sparse = false;
  std::size_t stride = 0;
  std::span<const std::byte> bytes;  ///< From the first element; empty: all are 0.
};

struct GltfDocument {
  SceneFolder folder;  ///< Where the files lie that it names.
  nlohmann::json json = {};
  std::vector<std::vector<std::byte>> buffers = {};
  std::vector<std::string> files = {};  ///< That buffers came from.

  [[nodiscard]] Field root() const { return {&json, ""}; }
  /// An element of one of the lists at the top, by a field that holds its index.
  [[nodiscard]] Field refer(const Field& index, const char* list) const;
};

/// The file with all its buffers, of which each is as long as it says.
GltfDocument open_gltf(std::span<const std::byte> file, const SceneFolder& folder);

/// The file without its buffers. @param bin is set to the buffer that lies in it, if any.
GltfDocument parse_gltf(std::span<const std::byte> file, const SceneFolder& folder,
                        std::optional<std::span<const std::byte>>& bin);
/// Reads them. @param bin as parse_gltf() sets it.
void load_buffers(GltfDocument& document, const std::optional<std::span<const std::byte>>& bin);

struct Resource {
  std::vector<std::byte> bytes;
  std::string file;  ///< Its path; empty: out of the document.
};

/// What an URI holds: a data URI, or a file in the document's folder.
Resource bytes_at(const GltfDocument& document, const Field& uri);

/// @param view a field with the index of a bufferView.
std::span<const std::byte> view_bytes(const GltfDocument& document, const Field& view);

/// @param accessor a field with the index of one.
Accessor open_accessor(const GltfDocument& document, const Field& accessor);

/// All its numbers as they are meant: sparse ones put in place, normalised integers divided.
/// @param components it must have.
std::vector<double> accessor_numbers(const GltfDocument& document, const Field& accessor, int components);

/// The same as vectors; none where it is absent. @param expected how many; 0: any.
template <class V>
std::vector<V> vectors(const GltfDocument& document, const Field& accessor, std::size_t expected) {
  std::vector<V> found;
  if (!accessor.there()) return found;
  const std::vector<double> numbers = accessor_numbers(document, accessor, V::length());
  found.resize(numbers.size() / std::size_t(V::length()));
  if (expected > 0 && found.size() != expected)
    accessor.fail(fmt::format("has {} values for {} vertices", found.size(), expected));
  for (std::size_t k = 0; k < numbers.size(); ++k)
    found[k / std::size_t(V::length())][int(k) % V::length()] = float(numbers[k]);
  return found;
}

}  // namespace envmap
