#include "cli/help.h"

#include <fmt/format.h>

#include <algorithm>

#include "cli/text.h"

namespace tools {
namespace {

constexpr std::size_t columns = 100, indent = 24;  // Of the texts beside the options.
constexpr std::size_t short_groups = 3;            // Of the command's own, that -h shows.

// Words in lines that begin at `indent`. @param left what stands before the first line.
std::string beside(std::string left, const std::string& text) {
  std::string out;
  left += std::string(left.size() + 1 < indent ? indent - left.size() : 1, ' ');
  for (const std::string& word : split(text, ' ')) {
    if (!left.ends_with(' ')) left += left.size() + 1 + word.size() > columns ? "\n" : " ";
    if (left.ends_with('\n')) out += left, left = std::string(indent, ' ');
    left += word;
  }
  return out + left + "\n";
}

std::string left_of(const Option& o) {
  return (o.letter != 0 ? fmt::format("  -{}, ", o.letter) : "  ") + o.name + (o.type.empty() ? "" : " " + o.type);
}

// The first of a command's own. What most commands share stays out.
std::vector<std::string_view> main_groups(const Options& options) {
  static constexpr std::string_view shared[] = {groups::input_map, groups::colour, groups::builds, groups::reports};
  std::vector<std::string_view> own = groups_of(options);
  std::erase_if(own, [](std::string_view group) { return std::ranges::find(shared, group) != std::end(shared); });
  own.resize(std::min(own.size(), short_groups));
  return own;
}

std::string examples(const Text& text, std::size_t most) {
  std::string all = "Examples:\n";
  for (std::size_t k = 0; k < std::min(most, text.examples.size()); ++k)
    all += fmt::format("  {}\n      {}\n", text.examples[k].command, text.examples[k].what);
  return all;
}

}  // namespace

std::vector<std::string_view> groups_of(const Options& options) {
  std::vector<std::string_view> groups;
  for (const Option& o : options.rows)
    if (!o.is_argument() && std::ranges::find(groups, o.group) == groups.end()) groups.push_back(o.group);
  return groups;
}

std::string help_of(const Command& command, const Options& options, bool all) {
  const Text text = text_of(command.name);
  std::string usage = fmt::format("{}\nUsage: envmap {} [OPTIONS]", text.summary, command.name), rows;
  for (const Option& o : options.rows) {
    if (!o.is_argument()) continue;
    const std::string name = o.name + (o.takes_several() ? "..." : "");
    usage += o.required ? " " + name : " [" + name + "]";
    rows += beside("  " + o.name, o.help);
  }
  const std::vector<std::string_view> groups = all ? groups_of(options) : main_groups(options);
  for (const std::string_view group : groups) {
    rows += fmt::format("{}:\n", group);
    for (const Option& o : options.rows)
      if (!o.is_argument() && !o.folded && o.group == group) rows += beside(left_of(o), o.help);
  }
  const std::string rest = groups.size() < groups_of(options).size() ? "All options: --help. " : "";
  return fmt::format("{}\n{}{}{}More examples, value ranges and background: man envmap-{}\n", usage, rows,
                     examples(text, 2), rest, command.name);
}

std::string overview() {
  std::string all =
      "Convert, prefilter, measure and render HDR environment maps\n"
      "Usage: envmap COMMAND [OPTIONS] ...\n"
      "Commands:\n";
  for (const Command& c : commands()) all += beside(fmt::format("  {}", c.name), text_of(c.name).summary);
  return all + "Options:\n" + beside("  -h, --help", "Print this help") +
         beside("  --version", "Print the version, the libraries and the renderer; also with --json") +
         "'envmap COMMAND -h' shows the main options of a command, 'envmap COMMAND --help' all of them.\n"
         "Manual: man envmap; recipes: man 7 envmap; symptoms: how-to/troubleshooting.md in share/doc/envmap\n";
}

}  // namespace tools
