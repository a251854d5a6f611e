// The options of a command as rows. Parsing, --help, man pages, completions, `batch` and --shard read them.
#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "envmap/base/bounds.h"
#include "envmap/base/words.h"
#include "envmap/maths/vector.h"

namespace tools {

using WordList = std::span<const std::string_view>;

/// A variable of an enumeration, optional or not, and the words of its enumerators.
struct Choice {
  void* variable;
  void (*put)(void* variable, int enumerator);
  WordList words;
};
template <class E>
Choice one_of(E& variable, WordList words) {
  return {&variable, [](void* v, int k) { *static_cast<E*>(v) = static_cast<E>(k); }, words};
}
template <class E>
Choice one_of(std::optional<E>& variable, WordList words) {
  return {&variable, [](void* v, int k) { *static_cast<std::optional<E>*>(v) = static_cast<E>(k); }, words};
}

/// R,G,B or X,Y,Z. With `one_for_all`, one number may stand for the three.
struct Triple {
  std::optional<envmap::Direction>* variable;
  bool one_for_all = false;
};

/// A number of bytes or pixels, such as 500M. Kilo is 1024, or 1000 if `decimal`.
struct Size {
  std::uint64_t* variable;
  bool decimal;
};

/// Where the value of an option goes.
using Value =
    std::variant<bool*, int*, std::optional<int>*, double*, std::optional<double>*, std::string*,
                 std::optional<std::string>*, std::vector<std::string>*, std::vector<double>*, Choice, Triple, Size>;
/// Reads a value itself. @return false where it takes no such word.
using Parse = std::function<bool(const std::string& text)>;

/// Both ends are allowed, NaN is not.
struct Range {
  double from, to;
};
/// The range that the library checks.
inline Range range_of(const envmap::Bounds& bounds) { return {bounds.least, bounds.most}; }

/// What a value names: a file that is read or written, a folder that is written, or files of which the last is written.
enum class File { none, input, output, folder, inputs_then_output };

/// How an option takes several values: as words that follow it, with commas between them, or one each time.
enum class Several { words, joined, repeated };

struct Option {
  std::string name;  ///< "--size"; of an argument "INPUT".
  std::string type;  ///< The value's name in help, such as N. Empty for flags and arguments.
  std::string help;
  Value value;
  Parse parse = {};                     ///< Used instead of `value`.
  std::vector<std::string> words = {};  ///< All words that are allowed; empty if any is.
  /// A word that is read as another one: what that was called in earlier versions. Help does not show it.
  std::pair<std::string_view, std::string_view> former = {};
  WordList suggested = {};              ///< Of an option that takes any word: what completions offer.
  std::string_view group = {};          ///< The heading in help.
  std::optional<Range> range = {};
  char letter = 0;  ///< q of -q, beside --quiet.
  File file = File::none;
  Several several = Several::words;
  bool required = false;
  bool folded = false;               ///< Has no line in --help: that of another option names it.
  std::string alone = {};            ///< The value of an option that is given without one.
  std::string environment = {};      ///< An environment variable that holds the value where the option is not given.
  std::string excludes = {};         ///< An option that may not stand beside this one.
  std::string needs = {};            ///< An option without which this one would do nothing.
  std::string all_inputs_with = {};  ///< Of inputs_then_output: an option that names the output in place of the last.
  std::vector<std::string> given = {};  ///< The values from the command line, or from the environment.
  bool from_environment = false;        ///< Whether `given` is from there.

  [[nodiscard]] bool is_argument() const { return !name.starts_with('-'); }
  [[nodiscard]] bool is_flag() const { return type.empty() && !is_argument(); }
  [[nodiscard]] bool takes_several() const;
  /// Reads one value. @throws std::invalid_argument with what is wrong.
  void put(const std::string& text) const;
};

/// The headings of --help that several commands share.
namespace groups {
constexpr std::string_view output_map = "Output map", output_file = "Output file", quality = "Quality",
                           input_map = "Input map", colour = "Colour and exposure", light = "Light",
                           builds = "Large maps and builds", reports = "Reports";
}

/// In the order of --help; rows of one group need not be neighbours. Rows keep their addresses. In the help of a row
/// with words, {} stands for them. The name may end with the name of the value: "--to PROJECTION".
class Options {
 public:
  std::string_view group;  ///< The heading of rows that are added from here on.
  Option& add(std::string_view name, std::string_view type, const Value& value, std::string_view help);
  Option& add(std::string_view name, std::string_view type, const Value& value, Range range, std::string_view help);
  Option& add(std::string_view name, std::string_view words, Parse parse, std::string_view help);
  Option& add(std::string_view name, const Choice& choice, std::string_view help);
  Option& flag(std::string_view name, bool& value, std::string_view help);
  /// Arguments.
  Option& reads(std::string_view name, std::string& path, std::string_view help);
  Option& writes(std::string_view name, std::string& path, std::string_view help);
  Option& files(std::vector<std::string>& paths, File kind, std::string_view help);

  [[nodiscard]] Option& operator[](std::string_view name);
  [[nodiscard]] bool has(std::string_view name) const;
  [[nodiscard]] bool given(std::string_view name) const;
  [[nodiscard]] bool on_command_line(std::string_view name) const;  ///< Not from the environment.
  [[nodiscard]] std::string last(std::string_view name) const;      ///< The value given last, or empty.
  /// The files that are named. @param kind input or output.
  [[nodiscard]] std::vector<std::string> named(File kind) const;
  /// The argument that names what is written, or the first option that does, or null.
  [[nodiscard]] const Option* output() const;
  /// The rows of these names would do nothing without that option.
  void need(std::string_view option, std::initializer_list<std::string_view> names);
  std::deque<Option> rows;
};

bool parse_number(const std::string& text, int& number);
bool parse_number(const std::string& text, double& number);
/// Three finite numbers with commas between them, or nothing. @see Triple
std::optional<envmap::Direction> triple_of(const std::string& text, bool one_for_all = false);
using envmap::split;

/// The index of a word, or -1.
int index_of(std::string_view word, WordList words);

}  // namespace tools
