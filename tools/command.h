// What every command is made of: its options, defined once for --help, man page and completions, and what it does.
#pragma once

#include <CLI/CLI.hpp>
#include <chrono>
#include <functional>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "envmap/io/display.h"
#include "envmap/io/output_file.h"
#include "envmap/io/read.h"
#include "envmap/io/write.h"
#include "envmap/base/progress.h"
#include "envmap/sample/filter.h"

namespace tools {

/// Options that every command has.
struct Common {
  int threads = 0;  ///< 0: all cores.
  bool quiet = false, verbose = false;
  bool json = false;
  std::string depfile;
  envmap::CommitOptions commit;
  /// Files that were read besides those that the user named: configs and tables of colours. For the depfile.
  std::shared_ptr<std::vector<std::string>> also_read = std::make_shared<std::vector<std::string>>();
};

struct Example {
  std::string command, what;
};

/// A key of what --json prints: `levels[].flux` is in each element of an array. @see schema_of for the types.
struct Key {
  std::string path, type, what;
};

struct Command {
  std::string name, summary, description;
  std::vector<Example> examples;
  std::vector<Key> keys = {};
  bool reports = false, writes = false;  ///< Has --json; has --depfile.
  /// Adds the options to `app`; returns what the command does, which gives the exit status.
  std::function<std::function<int()>(CLI::App& app, const Common& common)> define;
};

Command bake_command();
Command batch_command();
Command convert_command();
Command merge_command();
Command mipmap_command();
Command info_command();
Command compare_command();
Command generate_command();
Command preview_command();
Command prefilter_command();
Command sh_command();
Command render_command();
Command tradeoff_command();
Command view_command();
Command manual_command();
Command completion_command();

std::vector<Command> all_commands();

/// What --version says: the version, the commit where it is known, the libraries.
std::string version_text();

/// The program with all options of all commands; `run` is set to the action of the command that parsing meets.
std::unique_ptr<CLI::App> make_app(const std::vector<Command>& commands, Common& common, std::function<int()>& run);

/// The program as --help, man pages and completions read it.
struct Program {
  Common common;
  std::function<int()> run;
  std::vector<Command> commands = all_commands();
  std::unique_ptr<CLI::App> app = make_app(commands, common, run);
};

// ---- options ---------------------------------------------------------------------------------------------------------

/// An option that takes one of a few words. The type name `a|b|c` feeds help, man page and completions.
template <class T, class Parse>
CLI::Option* add_choice(CLI::App& app, const std::string& flag, T& value, std::string words, Parse parse,
                        const std::string& help) {
  return app
      .add_option_function<std::string>(
          flag,
          [&value, parse, flag, words](const std::string& word) {
            const auto found = parse(word);
            if (!found) throw CLI::ValidationError(flag, "'" + word + "' is none of " + words);
            value = *found;
          },
          help)
      ->type_name(words);
}

/// Index of a word in a list, as an enumerator.
template <class Enum>
auto one_of(std::span<const std::string_view> names) {
  return [names](std::string_view word) -> std::optional<Enum> {
    for (std::size_t k = 0; k < names.size(); ++k)
      if (names[k] == word) return static_cast<Enum>(k);
    return std::nullopt;
  };
}

std::string joined(std::span<const std::string_view> words);

CLI::Option* add_projection(CLI::App& app, const std::string& flag, std::optional<envmap::Projection>& value,
                            const std::string& help);
CLI::Option* add_layout(CLI::App& app, const std::string& flag, std::optional<envmap::Layout>& value, const std::string& help);
/// --filter: of convert, or absent for "auto".
CLI::Option* add_filter(CLI::App& app, std::optional<envmap::Filter>& value, const std::string& help);
CLI::Option* add_forward(CLI::App& app, const std::string& flag, std::optional<envmap::Forward>& value,
                         const std::string& help);
CLI::Option* add_depth(CLI::App& app, std::optional<envmap::Depth>& value);
/// @param otherwise what it is without the option, for the help.
CLI::Option* add_display(CLI::App& app, std::optional<envmap::Display>& value, envmap::Display otherwise);
/// A check of a number: CLI::Range itself lets NaN through, as that is neither too small nor too large.
CLI::Validator number_in(const CLI::Range& range);

CLI::Option* add_size(CLI::App& app, int& size, const std::string& help);
CLI::Option* add_size(CLI::App& app, std::optional<int>& size, const std::string& help);
void add_format(CLI::App& app, envmap::WriteOptions& options);
void add_clamp(CLI::App& app, envmap::WriteOptions& options);
/// Of a map that is written: --depth, --format, add_file_options() and --clamp.
void add_write_options(CLI::App& app, envmap::WriteOptions& options);

/// Three numbers with commas between them, or nothing; with `one_for_all`, one number may stand for the three.
std::optional<envmap::Direction> triple_of(const std::string& text, bool one_for_all = false);
CLI::Option* add_triple(CLI::App& app, const std::string& flag, std::optional<envmap::Direction>& value,
                        const std::string& type, bool one_for_all, const std::string& help);

/// The options of reading: --from, --from-layout, --from-forward and so on.
void add_read_options(CLI::App& app, envmap::ReadOptions& options);
/// What one file format alone knows: --openexr-envmap, --zstd.
void add_file_options(CLI::App& app, envmap::WriteOptions& options);
/// --max-memory, for commands that need few texels at a time.
void add_max_memory(CLI::App& app, envmap::ReadOptions& options);
/// --max-pixels: part of add_read_options(), for commands that read images otherwise.
void add_max_pixels(CLI::App& app, envmap::ReadOptions& options);
/// Of a map that is `size` high with the border on both sides. @throws UsageError where nothing is left.
int size_inside_border(int size, const envmap::WriteOptions& options);
/// --border. @param size what it says of --size.
void add_border(CLI::App& app, envmap::WriteOptions& options, const std::string& size);
/// --repair, for commands that want sound radiance.
void add_repair(CLI::App& app, envmap::ReadOptions& options);

// ---- doing -----------------------------------------------------------------------------------------------------------

/// A map from a file; repairs are told on standard error.
envmap::Source read_map(const std::string& path, const envmap::ReadOptions& options, const Common& common);

/// Makes and writes a map with its levels, tells what was clamped, writes the depfile. @param verb what the progress line
/// says.
envmap::Written write_map(const std::string& path, std::span<const envmap::Rows> levels, const envmap::WriteOptions& options,
                          const std::vector<std::string>& inputs, const std::string& verb, const Common& common);
envmap::Written write_map(const std::string& path, const envmap::Rows& rows, const envmap::WriteOptions& options,
                          const std::vector<std::string>& inputs, const std::string& verb, const Common& common);

/// The same without a depfile, for commands that write several files.
envmap::Written write_one_map(const std::string& path, std::span<const envmap::Rows> levels, const envmap::WriteOptions& options,
                              const std::string& verb, const Common& common);

/// A text as a file, or on standard output.
void write_text(const std::string& path, std::string_view text, const envmap::CommitOptions& how = {});

// ---- saying ----------------------------------------------------------------------------------------------------------

/// A line on standard error where that is a terminal, for work that takes over a second: how much is done, and the time left.
envmap::Progress progress_line(const Common& common, const std::string& what);

/// Tells the time since it was made.
class Stopwatch {
 public:
  [[nodiscard]] double seconds() const { return std::chrono::duration<double>(Clock::now() - start_).count(); }

 private:
  using Clock = std::chrono::steady_clock;
  Clock::time_point start_ = Clock::now();
};

/// Names come from users and from files: without what a terminal would obey, and what is no UTF-8. Line breaks stay.
std::string printable(std::string_view text);

/// The same inside SVG or HTML, as text or between double quotes.
std::string in_markup(std::string_view text);

/// Text on standard output, printable. Whether all of it could be written is asked once, at the end (not fmt::print, which
/// throws).
void print(std::string_view text);

/// A report as JSON on standard output, after `"version": 1`. Numbers that are not finite become null, and `not_finite` says
/// for each, by its JSON pointer, which it is: infinite, -infinite or nan.
void print_report(nlohmann::ordered_json report);

/// @throws UsageError where a report and an output would both go to standard output.
void check_report(const std::string& output, const Common& common);

/// What every command that writes a map reports of it: output, depth, clamped, flux_lost.
void add_written(nlohmann::ordered_json& report, const std::string& path, const envmap::Written& written);
/// Its keys after those of the command.
std::vector<Key> with_written(std::vector<Key> keys);

/// The keys of a command with those that every report has.
std::vector<Key> all_keys(const Command& command);
/// A JSON Schema of what a command's --json prints. Types: text, texts, words (an object of texts), number, count, boolean,
/// triple, triples, texel, object; "?" after one: may be absent; " or null".
nlohmann::ordered_json schema_of(const Command& command);

/// One line on standard error, of what makes the result another than was asked for: --quiet does not hide it.
void warn(std::string_view line);

/// One line on standard error unless --quiet.
void note(const Common& common, std::string_view line);

nlohmann::ordered_json to_json(const envmap::Direction& v);

}  // namespace tools
