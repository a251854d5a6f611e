#include "suggest.h"

#include <fmt/ranges.h>

#include <vector>

#include "envmap/base/near_words.h"

namespace tools {
namespace {

std::string closest(const std::string& word, const std::vector<std::string>& known) {
  const std::vector<std::string> near = envmap::near_words(word, known, 1);
  return near.empty() ? "" : fmt::format("; did you mean '{}'?", near[0]);
}

std::vector<std::string> option_names(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::Option* option : app.get_options())
    for (const std::string& n : option->get_lnames()) names.push_back("--" + n);
  return names;
}

}  // namespace

const CLI::App* find_command(const CLI::App& app, const std::string& name) {
  for (const CLI::App* sub : app.get_subcommands([](const CLI::App*) { return true; }))
    if (sub->get_name() == name) return sub;
  return nullptr;
}

std::string explain(const CLI::ParseError& error, const CLI::App& app, int argc, char** argv) {
  const std::string help =
      fmt::format(" (see 'envmap {}--help')", argc > 1 && argv[1][0] != '-' ? std::string(argv[1]) + " " : "");
  std::vector<std::string> commands;
  for (const CLI::App* sub : app.get_subcommands([](const CLI::App*) { return true; }))
    commands.push_back(sub->get_name());
  const CLI::App* command = argc > 1 ? find_command(app, argv[1]) : nullptr;
  if (argc < 2) return fmt::format("say a command: {} (see 'envmap --help')", fmt::join(commands, ", "));
  if (command == nullptr) {
    const std::string word = argv[1];
    if (word.starts_with("-"))
      return fmt::format("unknown option '{}'{} (see 'envmap --help')", word, closest(word, option_names(app)));
    return fmt::format("no command '{}'{} (see 'envmap --help')", word, closest(word, commands));
  }
  if (dynamic_cast<const CLI::ExtrasError*>(&error) != nullptr) {
    const std::vector<std::string> left = app.remaining(true);
    for (std::string word : left)
      if (word.size() > 1 && word[0] == '-') {
        word.resize(std::min(word.find('='), word.size()));
        return fmt::format("unknown option '{}'{}{}", word, closest(word, option_names(*command)), help);
      }
    if (!left.empty()) return fmt::format("'{}': one name too many{}", left.front(), help);
  }
  return error.what() + help;
}

}  // namespace tools
