#include "cli/command_line.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <sstream>
#include <string_view>

#include "cli/help.h"
#include "envmap/base/error.h"
#include "envmap/base/suggestions.h"

namespace tools {
namespace {

using envmap::UsageError;

// Values are looked at before files that are missing are: CLI11 2.6 looks at them after that, unless told otherwise.
template <class O>
void take_before_requirements(O* option) {
  if constexpr (requires { option->get_callback_priority(); })
    option->callback_priority(decltype(option->get_callback_priority())::PreRequirementsCheck);
}

void add(CLI::App& app, Option& o) {
  const auto put = [&o](const std::string& text) {
    try {
      o.put(text);
    } catch (const std::invalid_argument& e) {
      throw CLI::ValidationError(o.name, e.what());
    }
  };
  const std::string names = (o.letter != 0 ? std::string{'-', o.letter, ','} : "") + o.name;
  CLI::Option* option = nullptr;
  if (o.is_flag()) {
    option = app.add_flag_callback(
        names, [put] { put("true"); }, o.help);
    option->disable_flag_override();
  } else if (o.takes_several()) {
    const auto put_all = [put](const std::vector<std::string>& texts) { std::ranges::for_each(texts, put); };
    option = app.add_option_function<std::vector<std::string>>(names, put_all, o.help);
    if (o.several == Several::joined) option->delimiter(',');
    if (o.several == Several::repeated) option->allow_extra_args(false);
  } else {
    option = app.add_option_function<std::string>(names, put, o.help);
    if (!o.alone.empty()) option->expected(0, 1)->default_str(o.alone);
  }
  take_before_requirements(option);
  option->required(o.required);
  if (!o.is_flag()) option->type_name(o.type);
  if (!o.environment.empty()) option->envname(o.environment);
}

// The commands that have an option, in words.
std::string commands_with(const std::string& option) {
  std::vector<std::string> names;
  for (const Command& c : commands()) {
    Options options;
    Settings unused;
    define(c, options, unused);
    if (options.has(option)) names.push_back(fmt::format("'envmap {}'", c.name));
  }
  return fmt::format("{}", fmt::join(names, ", "));
}

std::string closest(const std::string& word, const std::vector<std::string>& known) {
  const std::vector<std::string> near = envmap::near_words(word, known, 1);
  return near.empty() ? "" : fmt::format("; did you mean '{}'?", near[0]);
}

// An option that the command does not have: another word was meant, or another command.
std::string explain_option(const std::string& word, const std::string& command, const Options& options) {
  std::vector<std::string> names;
  for (const Option& o : options.rows) names.push_back(o.name);
  const std::string near = closest(word, names), others = commands_with(word);
  const std::string there = others.empty() ? "" : fmt::format("'{}' is an option of {}", word, others);
  if (others.empty() || !near.empty())
    return fmt::format("unknown option '{}'{}{}{}", word, near, there.empty() ? "" : " ", there);
  if (command != "batch") return there;
  return fmt::format(
      "'{}' is an option of jobs: write them into a manifest, such as 'bake *.hdr {{name}} --for ENGINE {} ...'", word,
      word);
}

// A word that is no argument: the value of a flag, or one argument too many.
std::string explain_argument(const std::string& word, const std::string& command, const Options& options,
                             const std::vector<std::string>& words) {
  const auto at = std::ranges::find(words, word);
  const std::string before = at == words.begin() || at == words.end() ? "" : *(at - 1);
  for (const Option& o : options.rows)
    if (o.is_flag() && (before == o.name || before == std::string{'-', o.letter}))
      return fmt::format("{} takes no value: remove '{}'", before, word);
  std::vector<std::string> arguments;
  bool writes = false;
  for (const Option& o : options.rows)
    if (o.is_argument()) arguments.push_back(o.name), writes |= o.file != File::input;
  return fmt::format("unexpected argument '{}': {} takes {}; quote names that have spaces{}", word, command,
                     arguments.empty() ? "none" : fmt::format("{}", fmt::join(arguments, " ")),
                     writes || arguments.empty() ? "" : ", or use > FILE to save what it prints");
}

bool is_left_to_environment(const Option& o, const std::vector<std::string>& words) {
  return !o.environment.empty() &&
         std::ranges::none_of(words, [&](const std::string& word) { return word.starts_with(o.name); });
}

// CLI11 names the option where its value comes from the environment.
std::string with_source(std::string what, const Options& options, const std::vector<std::string>& words) {
  for (const Option& o : options.rows)
    if (what.starts_with(o.name) && is_left_to_environment(o, words)) what.replace(0, o.name.size(), o.environment);
  return what;
}

// One line: what is wrong, with the word that was probably meant.
std::string explain(const CLI::ParseError& error, const CLI::App& app, const std::vector<std::string>& words,
                    const Parsed& parsed) {
  std::vector<std::string> names;
  for (const Command& c : commands()) names.emplace_back(c.name);
  constexpr std::string_view help = " (see 'envmap --help')";
  if (words.empty()) return fmt::format("needs a command: {}{}", fmt::join(names, ", "), help);
  const std::string& first = words.front();
  if (first == "help" && words.size() == 1) return "no command 'help': use 'envmap --help'";
  if (first == "help") return fmt::format("no command 'help': use 'envmap {} --help'", words.back());
  const std::string near_start = closest(first, {"--help", "--version"});
  if (parsed.command == nullptr && first.starts_with("-"))
    return fmt::format("unknown option '{}'{}{}", first,
                       near_start.empty() ? ": options follow the command" : near_start, help);
  if (parsed.command == nullptr) return fmt::format("no command '{}'{}{}", first, closest(first, names), help);
  const std::string here = fmt::format(" (see 'envmap {} --help')", first);
  constexpr std::string_view twice = "ost 1 required but received ";  // "At Most"; from CLI11 2.6 on "At most".
  if (const std::string what = error.what(); what.find(": 1 required ") != what.npos && what.ends_with(" missing"))
    return fmt::format("{} needs a value{}", what.substr(0, what.find(':')), here);
  if (const std::string what = error.what(); what.find(twice) != what.npos)
    return fmt::format("{} takes one value, and is given {} times{}", what.substr(0, what.find(':')),
                       what.substr(what.find(twice) + twice.size()), here);
  constexpr std::string_view valued = " was given a disallowed flag override";
  if (const std::string what = error.what(); what.ends_with(valued))
    return fmt::format("--{} takes no value{}", what.substr(0, what.size() - valued.size()), here);
  if (dynamic_cast<const CLI::ExtrasError*>(&error) == nullptr)
    return with_source(error.what(), parsed.options, words) + here;
  const std::vector<std::string> left = app.remaining(true);
  for (std::string word : left)
    if (word.size() > 1 && word[0] == '-') {
      word.resize(std::min(word.find('='), word.size()));
      return explain_option(word, first, parsed.options) + here;
    }
  if (left.empty()) return error.what() + here;
  return explain_argument(left.front(), first, parsed.options, words) + here;
}

}  // namespace

void parse(const std::vector<std::string>& words, Parsed& parsed, Settings& settings) {
  CLI::App app("Convert, measure and make environment maps.", "envmap");
  app.set_version_flag("--version", [] { return version_text() + "\n" + renderer_text(); });
  if (std::ranges::is_permutation(words, std::array<std::string_view, 2>{"--version", "--json"}))
    throw HelpRequested{version_json()};
  app.require_subcommand(1);
  CLI::App* chosen = nullptr;
  for (const Command& command : commands()) {
    CLI::App* const sub = app.add_subcommand(std::string(command.name), "");
    if (!command.alias.empty()) sub->alias(std::string(command.alias));
    if (words.empty() || !command.is_named(words.front())) continue;
    chosen = sub, parsed.command = &command;
    parsed.action = define(command, parsed.options, settings);
    for (Option& o : parsed.options.rows)
      if (o.name != "--help") add(*sub, o);  // CLI11 has its own.
    for (const Option& o : parsed.options.rows)
      if (!o.excludes.empty()) sub->get_option(o.name)->excludes(o.excludes);
    sub->set_help_flag("-h", "");
    sub->set_help_all_flag("--help", "");
  }
  try {
    app.parse(std::vector<std::string>(words.rbegin(), words.rend()));
  } catch (const CLI::CallForHelp&) {
    throw HelpRequested{chosen == nullptr ? overview() : help_of(*parsed.command, parsed.options, false)};
  } catch (const CLI::CallForAllHelp&) {
    throw HelpRequested{help_of(*parsed.command, parsed.options, true)};
  } catch (const CLI::Success& e) {  // --version
    std::ostringstream text;
    app.exit(e, text, text);
    throw HelpRequested{text.str()};
  } catch (const CLI::ParseError& e) {
    throw UsageError(explain(e, app, words, parsed));
  }
  for (Option& o : parsed.options.rows) {
    o.given = chosen->get_option(o.name)->results();
    o.from_environment = is_left_to_environment(o, words);
  }
  for (const Option& o : parsed.options.rows)
    if (!o.needs.empty() && !o.given.empty() && !parsed.options.given(o.needs))
      throw UsageError(fmt::format("{} is for {}: use both, or neither", o.name, o.needs));
}

}  // namespace tools
