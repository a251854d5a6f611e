// Man pages out of the same definitions as --help.
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <limits>
#include <map>

#include "cli/console.h"
#include "cli/help.h"
#include "cli/text.h"
#include "command.h"
#include "envmap/base/error.h"
#include "envmap/base/system.h"
#include "maps/read_and_write_maps.h"

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

std::string range_words(const Option& o) {
  if (!o.range || std::holds_alternative<Size>(o.value)) return "";
  const bool whole = std::holds_alternative<int*>(o.value) || std::holds_alternative<std::optional<int>*>(o.value);
  const std::string what = whole ? "Whole number" : "Number";
  return o.range->to == std::numeric_limits<double>::max()
             ? fmt::format(" {}, {:g} or more.", what, o.range->from)
             : fmt::format(" {} from {:g} to {:.7g}.", what, o.range->from, o.range->to);
}

std::string option_lines(const Option& o, const Text& text) {
  std::string names = o.is_argument()
                          ? "\\fI" + roff(o.name) + "\\fR"
                          : (o.letter ? fmt::format("\\fB\\-{}\\fR, ", o.letter) : "") + "\\fB" + roff(o.name) + "\\fR";
  if (!o.type.empty()) names += " \\fI" + roff(o.type) + "\\fR";
  const auto detail = text.details.find(o.name);
  const std::string more = (detail == text.details.end() ? "" : " " + detail->second) + range_words(o);
  return ".TP\n" + names + "\n" + roff(o.help + (more.empty() ? "" : "." + more)) + "\n";
}

std::string argument_lines(const Options& options, const Text& text) {
  std::string out;
  for (const Option& o : options.rows)
    if (o.is_argument()) out += option_lines(o, text);
  return out;
}

std::string option_lines(const Options& options, const Text& text) {
  std::string out;
  for (const std::string_view group : groups_of(options)) {
    out += fmt::format(".SS {}\n", roff(std::string(group)));
    for (const Option& o : options.rows)
      if (!o.is_argument() && o.group == group) out += option_lines(o, text);
  }
  return out;
}

// `bold`, with the rest as roff() has it.
std::string marked(const std::string& text) {
  std::string out;
  bool bold = false;
  for (const std::string& part : split(text, '`')) {
    out += bold ? "\\fB" + roff(part) + "\\fR" : roff(part);
    bold = !bold;
  }
  return out;
}

// Rows "| a | b |", the first one with the titles. Wide columns wrap.
std::string table_lines(const std::string& text) {
  std::vector<std::vector<std::string>> rows;
  for (const std::string& line : split(text, '\n')) {
    rows.emplace_back();
    for (const std::string& cell : split(line.substr(2), '|')) {
      const std::size_t first = cell.find_first_not_of(' ');
      if (first != cell.npos) rows.back().push_back(cell.substr(first, cell.find_last_not_of(' ') + 1 - first));
    }
  }
  std::vector<std::size_t> widths(rows.front().size());
  for (const auto& row : rows)
    for (std::size_t k = 0; k < widths.size(); ++k) widths[k] = std::max(widths[k], row.at(k).size());
  constexpr std::size_t wide = 31;
  std::string titles, formats, lines;
  for (const std::size_t width : widths) titles += "lB ", formats += width > wide ? "lx " : "l ";
  for (std::size_t r = 0; r < rows.size(); ++r)
    for (std::size_t k = 0; k < widths.size(); ++k) {
      const std::string cell = marked(rows[r][k]);
      lines += (widths[k] > wide ? "T{\n.na\n" + cell + "\nT}" : cell) + (k + 1 < widths.size() ? "\t" : "\n");
    }
  titles.pop_back(), formats.pop_back();
  return fmt::format(".PP\n.TS\n{}\n{}.\n{}.TE\n", titles, formats, lines);
}

// A paragraph of a file in text/. @param heading SH or SS.
std::string paragraph_lines(const std::string& paragraph, std::string_view heading = "SS") {
  if (paragraph.starts_with("= ")) return fmt::format(".{} {}\n", heading, roff(paragraph.substr(2)));
  if (paragraph.starts_with("| ")) return table_lines(paragraph);
  if (paragraph.starts_with("- ")) return ".IP \\(bu 2\n" + marked(paragraph.substr(2)) + "\n";
  const std::size_t colon = paragraph.find(": ");
  if (paragraph.starts_with("* ") && colon != paragraph.npos)
    return ".TP\n\\fB" + roff(paragraph.substr(2, colon - 2)) + "\\fR\n" + marked(paragraph.substr(colon + 2)) + "\n";
  return ".PP\n" + marked(paragraph) + "\n";
}

std::string title(const std::string& name, int section = 1) {
  std::string upper = name;
  for (char& c : upper) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  return fmt::format(".TH {} {} \"\" \"envmap {}\" \"envmap\"\n", upper, section, ENVMAP_VERSION_TEXT);
}

struct ExitStatus {
  int status;
  std::string_view what;
  bool (*applies)(const Options& options);
};

bool reads_files(const Options& o) {
  return std::ranges::any_of(o.rows, [](const Option& row) {
    return row.is_argument() &&
           (row.file == File::input || row.file == File::inputs_then_output || row.name == "FILES");
  });
}

constexpr ExitStatus exit_statuses[] = {
    {0, "The command succeeded.", nullptr},
    {1, "A check failed: a limit such as --max-error is not met.",
     [](const Options& o) { return (o.has("--max-error") && !o.has("--orbit")) || o.has("--min-share"); }},
    {2, "The command line is wrong.", nullptr},
    {3, "An input cannot be read, or is damaged.", reads_files},
    {4, "An output cannot be written.", nullptr},
    {5, "No renderer was found.", [](const Options& o) { return o.has("--context") || o.has("--task"); }},
};

// @param options of a command, or null: all statuses.
std::string statuses(const Options* options) {
  const bool of_batch = options == nullptr || options->has("--jobs");
  const bool of_lights = options == nullptr || options->has("--min-share");
  std::string lines = ".SH EXIT STATUS\n";
  for (const ExitStatus& s : exit_statuses)
    if (options == nullptr || s.applies == nullptr || s.applies(*options))
      lines += fmt::format(".TP\n{}\n{}{}{}\n", s.status, roff(std::string(s.what)),
                           s.status == 4 && of_batch ? " Of batch: a job failed." : "",
                           s.status == 1 && of_lights ? " Of lights: no light was found." : "");
  return lines;
}

// Sections of an environment variable each: those that options name, and others.
std::string environment() {
  std::map<std::string, std::string> all{
      {"TMPDIR", "Folder of scratch files (default: /var/tmp for --max-memory, /tmp for standard output)."},
      {"ENVMAP_BASELINE",
       "If set, only the vector instructions of every x86-64 processor are used. The output is the same."}};
  for (const Command& c : commands()) {
    Options options;
    define(c, options);
    for (const Option& o : options.rows)
      if (!o.environment.empty()) all[o.environment] = fmt::format("Value of {} if the option is not given.", o.name);
  }
  std::string lines = ".SH ENVIRONMENT\n";
  for (const auto& [name, what] : all) lines += fmt::format(".TP\n{}\n{}\n", name, roff(what));
  return lines;
}

std::string json_lines(const Text& text) {
  std::string lines =
      ".SH JSON\n" +
      roff(
          "--json prints an object of these keys. NaN and infinity are written as null and listed under not_finite. "
          "'a[].b' is the key b of each object in the array a. 'envmap manual --schemas "
          "FOLDER' writes the JSON Schema.") +
      "\n";
  for (const Key& key : text.keys) lines += ".TP\n\\fB" + roff(key.path) + "\\fR\n" + roff(key.what) + "\n";
  return lines;
}

std::string command_page(const Command& command) {
  Options options;
  define(command, options);
  const Text text = text_of(command.name);
  std::string synopsis = fmt::format("\\fBenvmap {}\\fR [\\fIOPTIONS\\fR]", command.name), description, examples;
  for (const Option& o : options.rows)
    if (o.is_argument()) {
      const std::string word = "\\fI" + roff(o.name) + "\\fR" + (o.takes_several() ? "..." : "");
      synopsis += o.required ? " " + word : " [" + word + "]";
    }
  for (const std::string& paragraph : text.description) description += paragraph_lines(paragraph);
  for (const Example& e : text.examples) examples += ".TP\n\\fB" + roff(e.command) + "\\fR\n" + roff(e.what) + "\n";
  if (description.starts_with(".PP\n")) description.erase(0, 4);
  return title("envmap-" + std::string(command.name)) +
         fmt::format(
             ".SH NAME\nenvmap\\-{} \\- {}\n.SH SYNOPSIS\n{}\n.SH DESCRIPTION\n{}.SH ARGUMENTS\n{}.SH OPTIONS\n{}",
             command.name, roff(text.summary), synopsis, description, argument_lines(options, text),
             option_lines(options, text)) +
         (command.reports ? json_lines(text) : "") + ".SH EXAMPLES\n" + examples + statuses(&options) +
         ".SH SEE ALSO\n.BR envmap (1)\n";
}

std::string main_page() {
  std::string list, also;
  for (const Command& c : commands()) {
    list += fmt::format(".TP\n\\fBenvmap {}\\fR\n{}\n", c.name, roff(text_of(c.name).summary));
    also += fmt::format("{}.BR envmap\\-{} (1)", also.empty() ? "" : ",\n", c.name);
  }
  for (const char* topic :
       {"", "conventions", "orientation", "files", "accuracy", "cost", "prefilter", "scenes", "glossary"})
    also += fmt::format(",\n.BR envmap{}{} (7)", *topic ? "\\-" : "", topic);
  std::string description;
  for (const std::string& paragraph : text_of("envmap").description) description += paragraph_lines(paragraph);
  return title("envmap") + ".SH NAME\nenvmap \\- " + roff(text_of("envmap").summary) +
         "\n.SH SYNOPSIS\n\\fBenvmap\\fR \\fICOMMAND\\fR [\\fIOPTIONS\\fR] ...\n.SH DESCRIPTION\n" + description +
         ".SH COMMANDS\n" + list + statuses(nullptr) + environment() + ".SH SEE ALSO\n" + also + "\n";
}

// Pages of section 7 with tables of the program.
constexpr std::string_view topics[] = {"orientation", "files"};

std::string topic_page(std::string_view topic) {
  const Text text = text_of(topic);
  std::string page = fmt::format("'\\\" t\n{}.SH NAME\nenvmap\\-{} \\- {}\n", title(fmt::format("envmap-{}", topic), 7),
                                 topic, roff(text.summary));
  for (const std::string& paragraph : text.description) page += paragraph_lines(paragraph, "SH");
  return page + ".SH SEE ALSO\n.BR envmap (1),\n.BR envmap\\-conventions (7)\n";
}

// The folder of sample.hdr: as installed, or in the sources two folders above a program that was built there.
std::filesystem::path samples_folder() {
  const std::filesystem::path program = envmap::own_program().parent_path();
  std::error_code error;
  for (const char* place : {ENVMAP_SAMPLES_FROM_PROGRAM, "../../samples"})
    if (const auto folder = std::filesystem::weakly_canonical(program / place, error);
        !program.empty() && std::filesystem::exists(folder / "sample.hdr", error))
      return folder;
  throw envmap::InputError(program / ENVMAP_SAMPLES_FROM_PROGRAM,
                           "no sample.hdr there: install envmap anew, or take the folder samples of its sources");
}

void write_pages(const std::filesystem::path& to) {
  write_text(to / "envmap.1", main_page());
  for (const std::string_view topic : topics) write_text(to / fmt::format("envmap-{}.7", topic), topic_page(topic));
  for (const Command& c : commands()) write_text(to / fmt::format("envmap-{}.1", c.name), command_page(c));
}

void write_schemas(const std::filesystem::path& to) {
  for (const Command& c : commands())
    if (c.reports) write_text(to / fmt::format("{}.json", c.name), schema_of(c.name));
}

}  // namespace

Action define_manual(Options& o) {
  const auto folder = std::make_shared<std::string>();
  const auto schemas = std::make_shared<bool>(false), samples = std::make_shared<bool>(false);
  o.add("FOLDER", "", folder.get(), "Folder to write, which must exist");
  o.group = groups::output_file;
  o.flag("--schemas", *schemas, "Write JSON Schemas of the reports of --json instead of man pages");
  o.flag("--samples", *samples, "Print the folder of sample.hdr, the map of the examples");
  return [folder, schemas, samples](Report&) {
    if (*samples && (*schemas || !folder->empty()))
      throw envmap::UsageError("--samples writes nothing: give neither FOLDER nor --schemas");
    if (*samples)
      print(samples_folder().string() + "\n");
    else if (folder->empty())
      throw envmap::UsageError("FOLDER is required: the folder to write");
    else
      *schemas ? write_schemas(*folder) : write_pages(*folder);
    return 0;
  };
}

}  // namespace tools
