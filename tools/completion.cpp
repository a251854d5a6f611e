// Completions for bash, zsh and fish out of the same definitions as --help.
#include <fmt/format.h>

#include <algorithm>

#include "command.h"

namespace tools {
namespace {

enum class Shell { bash, zsh, fish };
constexpr std::string_view shell_names[] = {"bash", "zsh", "fish"};

// The words that an option or argument takes, with spaces between them; empty where it takes others.
std::string words_of(const CLI::Option& o) {
  std::string words = o.get_type_name();
  if (words.find('|') == std::string::npos) return {};
  std::replace(words.begin(), words.end(), '|', ' ');
  return words;
}

bool takes_value(const CLI::Option& o) { return o.get_items_expected_max() > 0; }

// What the first argument of a command may be, where it is one of some words.
std::string first_words(const CLI::App& command) {
  for (const CLI::Option* o : command.get_options())
    if (const std::string words = words_of(*o); o->get_positional() && !words.empty()) return words;
  return {};
}

// With a backslash before each of `special`.
std::string escaped(const std::string& text, std::string_view special) {
  std::string out;
  for (const char c : text) {
    if (special.find(c) != special.npos) out += '\\';
    out += c;
  }
  return out;
}

// ---- bash ------------------------------------------------------------------------------------------------------------

std::string bash(const Program& program) {
  std::string commands, cases;
  for (const Command& c : program.commands) {
    commands += (commands.empty() ? "" : " ") + c.name;
    const CLI::App& app = *program.app->get_subcommand(c.name);
    std::string options, values;
    const std::string first = first_words(app);
    for (const CLI::Option* o : app.get_options())
      for (const std::string& l : o->get_lnames()) {
        options += " --" + l;
        if (const std::string words = words_of(*o); !words.empty())
          values += fmt::format("        --{}) words=\"{}\" ;;\n", l, words);
        else if (takes_value(*o))
          values += fmt::format("        --{}) return ;;\n", l);
      }
    cases += fmt::format(
        "    {})\n      case \"$previous\" in\n{}        {}) words=\"{}\" ;;\n        *) words=\"{}\" ;;\n      esac "
        ";;\n",
        c.name, values, c.name, first.empty() ? options.substr(1) : first, options.substr(1));
  }
  return fmt::format(
      "# bash completion for envmap\n"
      "_envmap() {{\n"
      "  local word=\"${{COMP_WORDS[COMP_CWORD]}}\" previous=\"${{COMP_WORDS[COMP_CWORD-1]}}\" words=\"\"\n"
      "  if [ \"$COMP_CWORD\" -eq 1 ]; then\n"
      "    COMPREPLY=($(compgen -W \"{}\" -- \"$word\"))\n"
      "    return\n"
      "  fi\n"
      "  case \"${{COMP_WORDS[1]}}\" in\n{}  esac\n"
      "  case \"$word\" in\n"
      "    -*) ;;\n"
      "    *) case \"$previous\" in --*) ;; *) case \"$words\" in -*) words=\"\" ;; esac ;; esac ;;\n"
      "  esac\n"
      "  COMPREPLY=($(compgen -W \"$words\" -- \"$word\"))\n"
      "}}\n"
      "complete -o default -F _envmap envmap\n",
      commands, cases);
}

// ---- zsh -------------------------------------------------------------------------------------------------------------

// Inside single quotes.
std::string zsh_text(const std::string& text) {
  std::string out;
  for (const char c : text) out += c == '\'' ? "'\\''" : std::string(1, c);
  return out;
}

// One argument of zsh's _arguments: '--to[what it is]:P:(latlong cube)'.
std::string zsh_spec(const CLI::Option& o, const std::string& name) {
  std::string spec = name + "[" + zsh_text(escaped(o.get_description(), "[]\\:")) + "]";
  if (const std::string words = words_of(o); !words.empty())
    spec += ":word:(" + words + ")";
  else if (takes_value(o))
    spec += ":" + escaped(o.get_type_name(), "[]\\:") + ":_files";
  return " '" + spec + "'";
}

std::string zsh(const Program& program) {
  std::string commands, cases;
  for (const Command& c : program.commands) {
    commands += fmt::format("    '{}:{}'\n", c.name, zsh_text(escaped(c.summary, "\\:")));
    const CLI::App& app = *program.app->get_subcommand(c.name);
    cases += fmt::format("    {}) _arguments -S", c.name);
    for (const CLI::Option* o : app.get_options()) {
      for (const std::string& s : o->get_snames()) cases += zsh_spec(*o, "-" + s);
      for (const std::string& l : o->get_lnames()) cases += zsh_spec(*o, "--" + l);
    }
    const std::string first = first_words(app);
    cases += (first.empty() ? "" : " '1:word:(" + first + ")'") + std::string(" '*:file:_files' ;;\n");
  }
  return fmt::format(
      "#compdef envmap\n"
      "_envmap() {{\n"
      "  local -a commands=(\n{}  )\n"
      "  if (( CURRENT == 2 )); then\n"
      "    _describe command commands\n"
      "    return\n"
      "  fi\n"
      "  shift words\n"
      "  (( CURRENT-- ))\n"
      "  case $words[1] in\n{}  esac\n"
      "}}\n"
      // Found in $fpath the file is the function's body; sourced it defines it.
      "if [ \"$funcstack[1]\" = _envmap ]; then _envmap \"$@\"; else compdef _envmap envmap; fi\n",
      commands, cases);
}

// ---- fish ------------------------------------------------------------------------------------------------------------

std::string fish_quoted(const std::string& text) { return "'" + escaped(text, "'\\") + "'"; }

std::string fish(const Program& program) {
  std::string out = "# fish completion for envmap\n";
  for (const Command& c : program.commands) {
    out += fmt::format("complete -c envmap -n __fish_use_subcommand -f -a {} -d {}\n", c.name, fish_quoted(c.summary));
    const CLI::App& app = *program.app->get_subcommand(c.name);
    const std::string here = fmt::format("complete -c envmap -n '__fish_seen_subcommand_from {}'", c.name);
    if (const std::string first = first_words(app); !first.empty()) out += fmt::format("{} -a '{}'\n", here, first);
    for (const CLI::Option* o : app.get_options()) {
      if (o->get_positional()) continue;
      out += here;
      for (const std::string& s : o->get_snames()) out += " -s " + s;
      for (const std::string& l : o->get_lnames()) out += " -l " + l;
      if (const std::string words = words_of(*o); !words.empty())
        out += " -x -a '" + words + "'";
      else if (takes_value(*o))
        out += " -r";
      out += " -d " + fish_quoted(o->get_description()) + "\n";
    }
  }
  return out;
}

}  // namespace

Command completion_command() {
  return {
      .name = "completion",
      .summary = "Print the completions for bash, zsh or fish",
      .description =
          "Prints a script that completes commands, options and the words that options take. 'cmake --install' puts it "
          "where each shell looks for it.",
      .examples = {{"eval \"$(envmap completion)\"", "in ~/.bashrc"},
                   {"eval \"$(envmap completion zsh)\"", "in ~/.zshrc, after compinit"},
                   {"envmap completion fish > ~/.config/fish/completions/envmap.fish", "for fish"}},
      .define = [](CLI::App& app, const Common&) -> std::function<int()> {
        auto shell = std::make_shared<Shell>(Shell::bash);
        add_choice(app, "SHELL", *shell, joined(shell_names), one_of<Shell>(shell_names), "For which (default: bash)");
        return [shell] {
          const Program program;
          print(*shell == Shell::bash ? bash(program) : *shell == Shell::zsh ? zsh(program) : fish(program));
          return 0;
        };
      }};
}

}  // namespace tools
