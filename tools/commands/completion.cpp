// Completions for bash, zsh and fish out of the same definitions as --help.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "cli/console.h"
#include "cli/text.h"
#include "command.h"

namespace tools {
namespace {

enum class Shell { bash, zsh, fish };
constexpr std::string_view shell_names[] = {"bash", "zsh", "fish"};

struct Known {
  std::string name;
  std::string summary, first;  // What the first argument may be, where it is one of some words.
  Options options;
};

std::string words_of(const Option& o) {
  return o.words.empty() ? fmt::format("{}", fmt::join(o.suggested, " ")) : fmt::format("{}", fmt::join(o.words, " "));
}

std::deque<Known> all_known() {
  std::deque<Known> all;
  for (const Command& command : commands()) {
    all.push_back({.name = std::string(command.name), .summary = text_of(command.name).summary});
    Known& known = all.back();
    define(command, known.options);
    for (const Option& o : known.options.rows)
      if (o.is_argument() && known.first.empty()) known.first = words_of(o);
  }
  return all;
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

// ---- bash -----------------------------------------------------------------------------------------------------------

std::string bash(const std::deque<Known>& all) {
  std::string commands, cases;
  for (const Known& c : all) {
    commands += (commands.empty() ? "" : " ") + c.name;
    std::string options, values;
    const std::string& first = c.first;
    for (const Option& o : c.options.rows) {
      if (o.is_argument()) continue;
      options += " " + o.name;
      if (const std::string words = words_of(o); !words.empty())
        values += fmt::format("        {}) words=\"{}\" ;;\n", o.name, words);
      else if (!o.type.empty())
        values += fmt::format("        {}) return ;;\n", o.name);
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

// ---- zsh ------------------------------------------------------------------------------------------------------------

// Inside single quotes.
std::string zsh_text(const std::string& text) {
  std::string out;
  for (const char c : text) out += c == '\'' ? "'\\''" : std::string(1, c);
  return out;
}

// One argument of zsh's _arguments: '--to[what it is]:P:(latlong cube)'.
std::string zsh_spec(const Option& o, const std::string& name) {
  std::string spec = name + "[" + zsh_text(escaped(o.help, "[]\\:")) + "]";
  if (const std::string words = words_of(o); !words.empty())
    spec += ":word:(" + words + ")";
  else if (!o.type.empty())
    spec += fmt::format(":{}:_files", escaped(o.type, "[]\\:"));
  return fmt::format(" '{}'", spec);
}

std::string zsh(const std::deque<Known>& all) {
  std::string commands, cases;
  for (const Known& c : all) {
    commands += fmt::format("    '{}:{}'\n", c.name, zsh_text(escaped(c.summary, "\\:")));
    cases += fmt::format("    {}) _arguments -S", c.name);
    for (const Option& o : c.options.rows) {
      if (o.letter) cases += zsh_spec(o, std::string{'-', o.letter});
      if (!o.is_argument()) cases += zsh_spec(o, o.name);
    }
    const std::string& first = c.first;
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

// ---- fish -----------------------------------------------------------------------------------------------------------

std::string fish_quoted(const std::string& text) { return fmt::format("'{}'", escaped(text, "'\\")); }

std::string fish(const std::deque<Known>& all) {
  std::string out = "# fish completion for envmap\n";
  for (const Known& c : all) {
    out += fmt::format("complete -c envmap -n __fish_use_subcommand -f -a {} -d {}\n", c.name, fish_quoted(c.summary));
    const std::string here = fmt::format("complete -c envmap -n '__fish_seen_subcommand_from {}'", c.name);
    if (const std::string& first = c.first; !first.empty()) out += fmt::format("{} -a '{}'\n", here, first);
    for (const Option& o : c.options.rows) {
      if (o.is_argument()) continue;
      out += here + (o.letter ? fmt::format(" -s {}", o.letter) : "") + " -l " + o.name.substr(2);
      if (const std::string words = words_of(o); !words.empty())
        out += " -x -a '" + words + "'";
      else if (!o.type.empty())
        out += " -r";
      out += " -d " + fish_quoted(o.help) + "\n";
    }
  }
  return out;
}

}  // namespace

Action define_completion(Options& o) {
  const auto shell = std::make_shared<Shell>(Shell::bash);
  o.add("SHELL", one_of(*shell, shell_names), "{} (default: bash)");
  return [shell](Report&) {
    const std::deque<Known> all = all_known();
    print(*shell == Shell::bash ? bash(all) : *shell == Shell::zsh ? zsh(all) : fish(all));
    return 0;
  };
}

}  // namespace tools
