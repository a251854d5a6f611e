#include "suggest.h"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>
#include <vector>

namespace tools {
namespace {

// Levenshtein 1966.
std::size_t edit_distance(const std::string& a, const std::string& b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t above = row[j];
      row[j] = std::min({row[j] + 1, row[j - 1] + 1, diagonal + (a[i - 1] != b[j - 1])});
      diagonal = above;
    }
  }
  return row[b.size()];
}

std::string closest(const std::string& word, const std::vector<std::string>& known) {
  std::string best;
  std::size_t least = 1 + word.size() / 3;
  for (const std::string& k : known)
    if (const std::size_t d = edit_distance(word, k); d <= least && (best.empty() || d < least)) least = d, best = k;
  return best.empty() ? "" : fmt::format("; did you mean '{}'?", best);
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
