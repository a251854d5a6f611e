#include "cli/options.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace tools {
namespace {

[[noreturn]] void out_of(const std::string& text, const std::string& kind, const std::string& from,
                         const std::string& to) {
  throw std::invalid_argument(fmt::format("must be {}from {} to {}, not {}", kind, from, to, text));
}

template <class T>
T number(const Option& o, const std::string& text) {
  T value{};
  const bool is_number = parse_number(text, value);
  const std::string kind = std::is_integral_v<T> ? "a whole number" : "a number";
  if (!o.range && (!is_number || std::isnan(double(value))))
    throw std::invalid_argument(fmt::format("must be {}, not {}", kind, text));
  const auto in_words = [](double end) { return fmt::format("{:.7g}", end); };
  if (o.range && !(is_number && value >= o.range->from && value <= o.range->to)) {
    const std::string of = is_number && !std::isnan(double(value)) ? "" : kind + " ";
    if (o.range->to > 1e300)
      throw std::invalid_argument(fmt::format("must be {}of at least {}, not {}", of.empty() ? "a number " : of,
                                              in_words(o.range->from), text));
    out_of(text, of, in_words(o.range->from), in_words(o.range->to));
  }
  return value;
}

// 64M for 67108864: an end of the range in the unit of which it is a whole number, as it may be typed.
std::string in_units(double number, bool decimal) {
  const double step = decimal ? 1000 : 1024;
  std::size_t power = 0;
  for (; power < 4 && number >= step && std::fmod(number, step) == 0; ++power) number /= step;
  return fmt::format("{:.0f}{}", number, power == 0 ? "" : std::string(1, "KMGT"[power - 1]));
}

// 2G, 500 MB, 1kib: 1024 to the power of the letter, or 1000 where that is asked for and no i follows.
std::uint64_t size(const Option& o, const std::string& text, bool decimal) {
  const std::size_t digits = std::min(text.find_first_not_of("0123456789"), text.size());
  std::string unit = text.substr(digits);
  std::erase(unit, ' ');
  std::ranges::transform(unit, unit.begin(), [](unsigned char c) { return std::tolower(c); });
  if (unit.ends_with('b')) unit.pop_back();
  const bool binary = unit.ends_with('i');
  if (binary) unit.pop_back();
  const std::size_t power = unit.empty() ? 0 : 1 + std::string_view("kmgtpe").find(unit);
  if (digits == 0 || unit.size() > 1 || (power == 0 && !unit.empty()) || (binary && unit.empty()))
    throw std::invalid_argument("must be a size such as 500M, not " + text);
  const double bytes = std::strtod(text.c_str(), nullptr) * std::pow(decimal && !binary ? 1000 : 1024, double(power));
  if (bytes < o.range->from || bytes > o.range->to)
    out_of(text, "", in_units(o.range->from, decimal), in_units(o.range->to, decimal));
  return std::uint64_t(bytes);
}

// Words are taken in letters of either case.
std::string in_given_letters(const std::string& text, const std::vector<std::string>& words) {
  const auto small = [](unsigned char c) { return std::tolower(c); };
  const auto found = std::ranges::find_if(words, [&](const std::string& word) {
    return std::ranges::equal(word, text, {}, small, small);
  });
  return found == words.end() ? text : *found;
}

std::string not_among(const std::string& text, const Option& o) {
  return o.words.empty() ? fmt::format("must be {}, not {}", o.type, text)
                         : fmt::format("must be one of {}, not '{}'", fmt::join(o.words, ", "), text);
}

struct Putting {
  const Option& option;
  const std::string& text;

  void operator()(bool* v) const { *v = true; }
  void operator()(std::string* v) const { *v = text; }
  void operator()(std::optional<std::string>* v) const { *v = text; }
  void operator()(std::vector<std::string>* v) const { v->push_back(text); }
  void operator()(int* v) const { *v = number<int>(option, text); }
  void operator()(std::optional<int>* v) const { *v = number<int>(option, text); }
  void operator()(double* v) const { *v = number<double>(option, text); }
  void operator()(std::optional<double>* v) const { *v = number<double>(option, text); }
  void operator()(std::vector<double>* v) const { v->push_back(number<double>(option, text)); }
  void operator()(const Size& v) const { *v.variable = size(option, text, v.decimal); }
  void operator()(const Triple& v) const {
    *v.variable = triple_of(text, v.one_for_all);
    if (!*v.variable) throw std::invalid_argument(fmt::format("must be {}, not {}", option.type, text));
  }
  void operator()(const Choice& v) const {
    const int k = index_of(text, v.words);
    if (k < 0) throw std::invalid_argument(not_among(text, option));
    v.put(v.variable, k);
  }
};

// "--size" of "--size N", and N of it; else N is SIZE.
std::pair<std::string, std::string> name_and_type(std::string_view name) {
  const std::size_t space = name.find(' ');
  if (space != name.npos) return {std::string(name.substr(0, space)), std::string(name.substr(space + 1))};
  std::string type(name.substr(name.rfind('-') + 1));
  std::ranges::transform(type, type.begin(), [](unsigned char c) { return std::toupper(c); });
  return {std::string(name), name.starts_with('-') ? type : ""};
}

std::string with_words(std::string help, const std::vector<std::string>& words) {
  const std::size_t mark = help.find("{}");
  return mark == help.npos ? help : help.replace(mark, 2, fmt::format("{}", fmt::join(words, " ")));
}

}  // namespace

bool Option::takes_several() const {
  return !parse && (std::holds_alternative<std::vector<std::string>*>(value) ||
                    std::holds_alternative<std::vector<double>*>(value));
}

void Option::put(const std::string& text) const {
  if (file != File::none && text.empty()) throw std::invalid_argument("the name is empty (is a variable not set?)");
  const std::string word =
      !text.empty() && text == former.first ? std::string(former.second) : in_given_letters(text, words);
  if (!parse) std::visit(Putting{*this, word}, value);
  if (parse && !parse(word)) throw std::invalid_argument(not_among(text, *this));
}

Option& Options::add(std::string_view name, std::string_view type, const Value& value, std::string_view help) {
  Option& o = rows.emplace_back(Option{std::string(name), std::string(type), std::string(help), value});
  o.group = group;
  if (name.size() > 1 && name[0] == '-' && name[1] != '-') o.letter = name[1], o.name = name.substr(3);  // "-q,--quiet"
  return o;
}
Option& Options::add(std::string_view name, std::string_view type, const Value& value, Range range,
                     std::string_view help) {
  Option& o = add(name, type, value, help);
  o.range = range;
  if (o.takes_several()) o.several = Several::joined;
  return o;
}
Option& Options::add(std::string_view name, std::string_view words, Parse parse, std::string_view help) {
  const bool several = words.find('|') != words.npos;
  const auto [flag, type] = name_and_type(name);
  Option& o = add(flag, several ? type : std::string(words), Value{}, help);
  o.parse = std::move(parse);
  if (several) o.words = split(std::string(words), '|');
  o.help = with_words(o.help, o.words);
  return o;
}
Option& Options::add(std::string_view name, const Choice& choice, std::string_view help) {
  const auto [flag, type] = name_and_type(name);
  Option& o = add(flag, type, choice, help);
  o.words.assign(choice.words.begin(), choice.words.end());
  o.help = with_words(o.help, o.words);
  return o;
}
Option& Options::flag(std::string_view name, bool& value, std::string_view help) { return add(name, "", &value, help); }
Option& Options::reads(std::string_view name, std::string& path, std::string_view help) {
  Option& o = add(name, "", &path, help);
  o.file = File::input;
  return o;
}
Option& Options::writes(std::string_view name, std::string& path, std::string_view help) {
  Option& o = add(name, "", &path, help);
  o.file = File::output;
  return o;
}

Option& Options::files(std::vector<std::string>& paths, File kind, std::string_view help) {
  Option& o = add("FILES", "", &paths, help);
  o.file = kind, o.required = true;
  return o;
}

Option& Options::operator[](std::string_view name) { return *std::ranges::find(rows, name, &Option::name); }
bool Options::has(std::string_view name) const { return std::ranges::find(rows, name, &Option::name) != rows.end(); }
bool Options::given(std::string_view name) const {
  const auto found = std::ranges::find(rows, name, &Option::name);
  return found != rows.end() && !found->given.empty();
}
bool Options::on_command_line(std::string_view name) const {
  const auto found = std::ranges::find(rows, name, &Option::name);
  return found != rows.end() && !found->given.empty() && !found->from_environment;
}
std::string Options::last(std::string_view name) const {
  const auto found = std::ranges::find(rows, name, &Option::name);
  return found != rows.end() && !found->given.empty() ? in_given_letters(found->given.back(), found->words) : "";
}
std::vector<std::string> Options::named(File kind) const {
  std::vector<std::string> all;
  for (const Option& o : rows) {
    auto first = o.given.begin(), last = o.given.end();
    const bool ends_in_output = o.file == File::inputs_then_output && !given(o.all_inputs_with);
    if (ends_in_output && kind != File::folder && first != last)
      (kind == File::input ? last : first) = last - 1;
    else if (o.file != kind && !(o.file == File::inputs_then_output && kind == File::input))
      continue;
    all.insert(all.end(), first, last);
  }
  return all;
}

const Option* Options::output() const {
  const auto writes = [](const Option& o) { return o.file != File::none && o.file != File::input; };
  const auto is_argument_that_writes = [&](const Option& o) { return o.is_argument() && writes(o); };
  auto found = std::ranges::find_if(rows, is_argument_that_writes);
  if (found == rows.end()) found = std::ranges::find_if(rows, writes);
  return found == rows.end() ? nullptr : &*found;
}
void Options::need(std::string_view option, std::initializer_list<std::string_view> names) {
  for (const std::string_view name : names) (*this)[name].needs = option;
}

bool parse_number(const std::string& text, int& number) {
  char* end = nullptr;
  const long long value = std::strtoll(text.c_str(), &end, 10);
  number = int(value);
  return !text.empty() && end == text.c_str() + text.size() && number == value;
}
bool parse_number(const std::string& text, double& number) {
  char* end = nullptr;
  number = double(std::strtold(text.c_str(), &end));
  return !text.empty() && end == text.c_str() + text.size();
}

std::optional<envmap::Direction> triple_of(const std::string& text, bool one_for_all) {
  std::vector<double> numbers;
  for (const std::string& part : split(text, ','))
    if (!parse_number(part, numbers.emplace_back()) || !std::isfinite(numbers.back())) return std::nullopt;
  if (one_for_all && numbers.size() == 1) numbers.assign(3, numbers[0]);
  if (numbers.size() != 3) return std::nullopt;
  return envmap::Direction(numbers[0], numbers[1], numbers[2]);
}

int index_of(std::string_view word, WordList words) {
  const auto found = std::ranges::find(words, word);
  return found == words.end() ? -1 : int(found - words.begin());
}

}  // namespace tools
