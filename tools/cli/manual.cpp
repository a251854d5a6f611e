// Man pages out of the same definitions as --help.
#include <fmt/format.h>

#include <filesystem>

#include "cli/text.h"
#include "command.h"
#include "shared/maps.h"

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

std::string option_lines(const Options& options, bool arguments) {
  std::string out;
  for (const Option& o : options.rows) {
    if (o.is_argument() != arguments) continue;
    std::string names =
        arguments ? "\\fI" + roff(o.name) + "\\fR"
                  : (o.letter ? fmt::format("\\fB\\-{}\\fR, ", o.letter) : "") + "\\fB" + roff(o.name) + "\\fR";
    if (!o.type.empty() && (!arguments || !o.words().empty())) names += " \\fI" + roff(o.type) + "\\fR";
    out += ".TP\n" + names + "\n" + roff(o.help) + "\n";
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

std::string command_page(const Command& command) {
  Options options;
  define(command, options);
  const Text text = text_of(command.name);
  std::string synopsis = fmt::format("\\fBenvmap {}\\fR [\\fIOPTIONS\\fR]", command.name), description, examples, keys;
  for (const Option& o : options.rows)
    if (o.is_argument()) synopsis += " \\fI" + roff(o.name) + "\\fR" + (o.takes_several() ? "..." : "");
  for (const std::string& paragraph : text.description)
    description += (description.empty() ? "" : ".PP\n") + roff(paragraph) + "\n";
  for (const Example& e : text.examples) examples += ".TP\n\\fB" + roff(e.command) + "\\fR\n" + roff(e.what) + "\n";
  if (command.reports) {
    keys = ".SH JSON\n" +
           roff(
               "--json prints one object. A number that is not finite is null there. 'levels[].flux' below is the key "
               "flux of each "
               "object in the array levels. 'envmap manual --schemas FOLDER' writes the JSON Schema of it.") +
           "\n";
    for (const Key& key : text.keys) keys += ".TP\n\\fB" + roff(key.path) + "\\fR\n" + roff(key.what) + "\n";
  }
  return fmt::format(
      "{}.SH NAME\nenvmap\\-{} \\- {}\n.SH SYNOPSIS\n{}\n.SH DESCRIPTION\n{}.SH ARGUMENTS\n{}.SH OPTIONS\n{}{}.SH "
      "EXAMPLES\n{}{}.SH SEE ALSO\n.BR envmap (1)\n",
      title("envmap-" + std::string(command.name)), command.name, roff(text.summary), synopsis, description,
      option_lines(options, true), option_lines(options, false), keys, examples, statuses());
}

std::string main_page() {
  std::string list, also;
  for (const Command& c : commands()) {
    list += fmt::format(".TP\n\\fBenvmap {}\\fR\n{}\n", c.name, roff(text_of(c.name).summary));
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

}  // namespace

Action define_manual(Options& o) {
  const auto folder = std::make_shared<std::string>();
  const auto schemas = std::make_shared<bool>(false);
  o.add("FOLDER", "TEXT", folder.get(), "Where to write them").required = true;
  o.flag("--schemas", *schemas, "Write JSON Schemas of what --json prints instead");
  return [folder, schemas](Report&) {
    const std::filesystem::path to = *folder;
    if (!*schemas) write_text(to / "envmap.1", main_page());
    for (const Command& c : commands())
      if (!*schemas)
        write_text(to / fmt::format("envmap-{}.1", c.name), command_page(c));
      else if (c.reports)
        write_text(to / fmt::format("{}.json", c.name), schema_of(c.name));
    return 0;
  };
}

}  // namespace tools
