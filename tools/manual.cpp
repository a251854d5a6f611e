// Man pages out of the same definitions as --help.
#include <fmt/format.h>

#include <filesystem>

#include "command.h"

namespace tools {
namespace {

// Text for roff: what it would read as commands is escaped.
std::string roff(const std::string& text) {
  std::string out;
  bool line_start = true;
  for (const char c : text) {
    if (c == '\\')
      out += "\\e";
    else if (c == '-')
      out += "\\-";
    else if (line_start && (c == '.' || c == '\''))
      out += std::string("\\&") + c;
    else
      out += c;
    line_start = c == '\n';
  }
  return out;
}

std::string paragraphs(std::string text) {
  for (std::size_t at; (at = text.find("\n\n")) != std::string::npos;) text.replace(at, 2, "\n.PP\n");
  std::string out;
  for (std::size_t begin = 0; begin <= text.size();) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    const std::string line = text.substr(begin, end - begin);
    out += (line == ".PP" ? line : roff(line)) + "\n";
    begin = end + 1;
  }
  return out;
}

std::string option_lines(const CLI::App& app, bool positional) {
  std::string out;
  for (const CLI::Option* o : app.get_options()) {
    if (o->get_positional() != positional) continue;
    const bool takes = o->get_items_expected_max() > 0;
    std::string names;
    if (positional) {
      names = "\\fI" + roff(o->get_name(true)) + "\\fR";
    } else {
      for (const std::string& s : o->get_snames()) names += "\\fB\\-" + roff(s) + "\\fR, ";
      for (const std::string& l : o->get_lnames()) names += "\\fB\\-\\-" + roff(l) + "\\fR";
    }
    if (takes && (!positional || o->get_type_name().find('|') != std::string::npos))
      names += " \\fI" + roff(o->get_type_name()) + "\\fR";
    out += ".TP\n" + names + "\n" + roff(o->get_description()) + "\n";
  }
  return out;
}

std::string title(const std::string& name) {
  std::string upper = name;
  for (char& c : upper) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  return fmt::format(".TH {} 1 \"\" \"envmap {}\" \"envmap\"\n", upper, ENVMAP_VERSION);
}

std::string statuses() {
  return ".SH EXIT STATUS\n"
         ".TP\n0\ndone\n.TP\n1\nthe answer is no: a limit that was given is exceeded\n.TP\n2\nusage\n"
         ".TP\n3\nan input is unreadable or not what it claims to be\n.TP\n4\nan output was not written\n"
         ".TP\n5\nthere is nothing to draw with: no renderer\n";
}

std::string command_page(const Command& command, const CLI::App& app) {
  std::string synopsis = "\\fBenvmap " + command.name + "\\fR [\\fIOPTIONS\\fR]";
  for (const CLI::Option* o : app.get_options())
    if (o->get_positional())
      synopsis += " \\fI" + roff(o->get_name(true)) + "\\fR" + (o->get_expected_max() > 1 ? "..." : "");
  std::string examples;
  for (const Example& e : command.examples) examples += ".TP\n\\fB" + roff(e.command) + "\\fR\n" + roff(e.what) + "\n";
  std::string keys;
  if (command.reports) {
    keys = ".SH JSON\n" + roff("--json prints one object. A number that is not finite is null there. 'levels[].flux' below "
                               "is the key flux of each object in the array levels. 'envmap manual --schemas FOLDER' writes "
                               "the JSON Schema of it.") + "\n";
    for (const Key& key : all_keys(command)) keys += ".TP\n\\fB" + roff(key.path) + "\\fR\n" + roff(key.what) + "\n";
  }
  return title("envmap-" + command.name) + ".SH NAME\nenvmap\\-" + command.name + " \\- " + roff(command.summary) +
         "\n.SH SYNOPSIS\n" + synopsis + "\n.SH DESCRIPTION\n" + paragraphs(command.description) + ".SH ARGUMENTS\n" +
         option_lines(app, true) + ".SH OPTIONS\n" + option_lines(app, false) + keys + ".SH EXAMPLES\n" + examples +
         statuses() + ".SH SEE ALSO\n.BR envmap (1)\n";
}

std::string main_page(const std::vector<Command>& commands) {
  std::string list, also;
  for (const Command& c : commands) {
    list += ".TP\n\\fBenvmap " + c.name + "\\fR\n" + roff(c.summary) + "\n";
    also += fmt::format("{}.BR envmap\\-{} (1)", also.empty() ? "" : ",\n", c.name);
  }
  for (const char* topic : {"", "conventions", "files", "accuracy", "prefilter", "scenes", "performance"})
    also += fmt::format(",\n.BR envmap{}{} (7)", *topic ? "\\-" : "", topic);
  return title("envmap") + ".SH NAME\nenvmap \\- " + roff("convert, measure and make environment maps") +
         "\n.SH SYNOPSIS\n\\fBenvmap\\fR \\fICOMMAND\\fR [\\fIOPTIONS\\fR] ...\n" + ".SH DESCRIPTION\n" +
         roff(
             "Environment maps are HDR images of all directions around a point. Pixels are linear RGB radiance. The "
             "frame is "
             "right-handed with +Y up; +Z lies at the centre of latlong and angular images. Projections may be called equirect or "
            "equirectangular (latlong), cubemap (cube), mirrorball (sphere) and lightprobe (angular), too. A file name '-' is "
             "standard input or "
             "output (EXR, of pictures PNG, unless --format says another). Output files appear whole or not at all, and the same command gives the same bytes at any number "
             "of threads.") +
         "\n.SH COMMANDS\n" + list + statuses() +
         ".SH ENVIRONMENT\n.TP\nTMPDIR\nwhere scratch files of \\-\\-max\\-memory lie, else /var/tmp, and what goes to standard "
         "output until it is whole, else /tmp\n"
         ".TP\nENVMAP_BASELINE\nif set, only vector instructions that every x86\\-64 processor has are used: the same "
         "bytes, slower\n"
         ".TP\nENVMAP_THREADS\nhow many threads to use where \\-\\-threads does not say\n" ".SH SEE ALSO\n" + also + "\n";
}

int write_schemas(const std::string& folder) {
  for (const Command& c : all_commands())
    if (c.reports) write_text(std::filesystem::path(folder) / (c.name + ".json"), schema_of(c).dump(2) + "\n");
  return 0;
}

int write_pages(const std::string& folder) {
  const Program all;
  write_text(std::filesystem::path(folder) / "envmap.1", main_page(all.commands));
  for (const Command& c : all.commands)
    write_text(std::filesystem::path(folder) / ("envmap-" + c.name + ".1"), command_page(c, *all.app->get_subcommand(c.name)));
  return 0;
}

}  // namespace

Command manual_command() {
  return {.name = "manual",
          .summary = "Write the man pages",
          .description =
              "Writes envmap.1 and a page for each command into a folder. They hold what --help shows, from the same "
              "definitions. With --schemas it writes instead a JSON Schema (2020-12) for each command that has --json, to check its "
              "reports with or to make types of: info.json, compare.json ...",
          .examples = {{"envmap manual man", "refresh the pages kept in the repository"},
                       {"envmap manual /tmp && man /tmp/envmap-convert.1", "read a page without installing it"},
                       {"envmap manual --schemas . && envmap info probe.exr --json > probe.json && jsonschema -i probe.json info.json",
                        "a report held against its schema"}},
          .define = [](CLI::App& app, const Common&) -> std::function<int()> {
            auto folder = std::make_shared<std::string>();
            app.add_option("FOLDER", *folder, "Where to write them")->required();
            auto schemas = std::make_shared<bool>(false);
            app.add_flag("--schemas", *schemas, "Write JSON Schemas of what --json prints instead");
            return [folder, schemas] { return *schemas ? write_schemas(*folder) : write_pages(*folder); };
          }};
}

}  // namespace tools
