// What --json prints. text/COMMAND.txt lists the keys of a command with their types and meanings.
#pragma once

#include <array>
#include <concepts>
#include <cstdint>
#include <initializer_list>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "cli/console.h"
#include "envmap/io/write.h"
#include "envmap/maths/vector.h"

namespace tools {

/// The value of a key. A number that is not finite becomes null, and the key `not_finite` says what it is.
class ReportValue {
 public:
  using Texel = std::array<int, 2>;
  std::variant<std::nullptr_t, bool, std::int64_t, double, std::string, envmap::Direction, Texel,
               std::vector<std::string>>
      value;

  ReportValue(std::nullptr_t) : value(nullptr) {}
  ReportValue(bool b) : value(b) {}
  ReportValue(std::integral auto n) : value(std::int64_t(n)) {}
  ReportValue(std::floating_point auto x) : value(double(x)) {}
  ReportValue(std::string_view text) : value(std::string(text)) {}
  ReportValue(const std::string& text) : value(text) {}
  ReportValue(const char* text) : value(std::string(text)) {}
  ReportValue(const envmap::Direction& v) : value(v) {}
  ReportValue(const Texel& texel) : value(texel) {}
  ReportValue(const std::vector<std::string>& texts) : value(texts) {}
  template <class T>
  ReportValue(const std::optional<T>& o) : ReportValue(o ? ReportValue(*o) : ReportValue(nullptr)) {}
};

class Report {
 public:
  Report();
  ~Report();
  /// @param key "error.max", or "levels[].size" of the last element of levels.
  void put(std::string_view key, const ReportValue& value);
  /// Appends an element to an array. @param key "levels[]".
  void append(std::string_view key);
  void append(std::string_view key, const ReportValue& value);
  /// Makes an array without elements. @param key "levels".
  void put_array(std::string_view key);
  /// Puts a text into an object whose keys come from a file.
  void put_word(std::string_view key, const std::string& word, const std::string& text);
  /// The keys of a map that was written: output, depth, clamped, flux_lost.
  void put_written(const std::string& path, const envmap::Written& written);
  /// Those of the last element of an array. @param array "maps[]".
  void put_written(std::string_view array, const std::string& path, const envmap::Written& written);
  /// The time since the report was begun.
  void put_seconds();

  [[nodiscard]] bool empty() const;
  /// JSON with the keys `version` and, where one is needed, `not_finite`.
  [[nodiscard]] std::string text() const;
  /// The keys alone, on one line.
  [[nodiscard]] std::string line() const;

 private:
  struct Json;
  std::unique_ptr<Json> json_;
  Stopwatch watch_;
};

/// The JSON Schema of what a command's --json prints.
std::string schema_of(std::string_view command);

}  // namespace tools
