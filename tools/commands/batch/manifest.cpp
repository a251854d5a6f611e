#include "commands/batch/manifest.h"

#include <fmt/format.h>
#include <fnmatch.h>
#include <glob.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <iterator>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>

#include "cli/command_line.h"
#include "commands/batch/schedule.h"
#include "envmap/base/error.h"
#include "envmap/engine/bake.h"
#include "envmap/engine/engines.h"
#include "maps/depfile.h"
#include "scenes/place_files.h"
#include "scenes/scene_options.h"

namespace tools {
namespace {

using namespace envmap;
namespace fs = std::filesystem;
using Texts = std::vector<std::string>;

// A word, and the same for glob(), where a quoted * ? or [ stands for itself.
struct Word {
  std::string text, glob;
  bool is_pattern = false;

  void append(char c, bool quoted) {
    const bool special = c == '*' || c == '?' || c == '[';
    text += c;
    if (c == '\\' || (special && quoted)) glob += '\\';
    glob += c;
    is_pattern = is_pattern || (special && !quoted);
  }
};
Word word_of(const std::string& text, bool quoted) {
  Word word;
  for (const char c : text) word.append(c, quoted);
  return word;
}

struct Line {
  std::string where;
  std::vector<Word> words;
};

// A line as a shell cuts it: '...' as it stands, "..." and what follows a backslash without its meaning,
// # begins a comment.
std::vector<Word> split(const std::string& line, const std::string& where) {
  std::vector<Word> words;
  bool open = false;
  char quote = 0;
  for (std::size_t k = 0; k < line.size(); ++k) {
    const char c = line[k];
    if (quote == 0 && (c == ' ' || c == '\t' || c == '\r')) {
      open = false;
      continue;
    }
    if (quote == 0 && !open && c == '#') break;
    if (!open) words.emplace_back();
    open = true;
    if (quote != 0 && c == quote)
      quote = 0;
    else if (quote == 0 && (c == '\'' || c == '"'))
      quote = c;
    else if (c == '\\' && k + 1 < line.size() &&
             (quote == 0 || (quote == '"' && std::string_view("$`\"\\").find(line[k + 1]) != std::string_view::npos)))
      words.back().append(line[++k], true);
    else
      words.back().append(c, quote != 0);
  }
  if (quote != 0) throw UsageError(fmt::format("{}: a quotation mark {} is not closed", where, quote));
  return words;
}

std::vector<Line> lines_of_json(const std::string& path, const std::string& text) {
  const auto json = nlohmann::ordered_json::parse(text, nullptr, false);
  if (!json.is_array()) throw InputError(path, "is no JSON array of commands");
  std::vector<Line> lines;
  for (const auto& job : json) {
    Line line{fmt::format("job {}", lines.size() + 1), {}};
    if (job.is_string())
      line.words = split(job.get<std::string>(), line.where);
    else if (job.is_array() &&
             std::ranges::all_of(job, [](const auto& word) { return word.is_string() || word.is_number(); }))
      for (const auto& word : job)
        line.words.push_back(word_of(word.is_number() ? word.dump() : word.template get<std::string>(), false));
    else
      throw InputError(path, fmt::format("{} is neither a command line nor an array of words and numbers", line.where));
    lines.push_back(line);
  }
  return lines;
}

std::vector<Line> lines_of_text(const std::string& text) {
  std::vector<Line> lines;
  std::istringstream in(text);
  int number = 0;
  for (std::string line; std::getline(in, line);) {
    const std::string where = fmt::format("line {}", ++number);
    if (const std::vector<Word> words = split(line, where); !words.empty()) lines.push_back({where, words});
  }
  return lines;
}

bool is_place(const Word& word) {
  return word.text.find("{stem}") != word.text.npos || word.text.find("{name}") != word.text.npos;
}

// What is written, and the file it is made of; an empty name where that is more than one.
using Sources = std::map<std::string, std::string>;

// Files that are there or that earlier lines write, without those that the line itself makes of others.
Texts matching(const Word& word, const std::set<std::string>& written, const Sources& made, const std::string& where) {
  const std::string &pattern = word.glob, plain = plain_path(pattern);
  std::set<std::string> found;
  glob_t files = {};
  if (::glob(pattern.c_str(), 0, nullptr, &files) == 0)
    std::transform(files.gl_pathv, files.gl_pathv + files.gl_pathc, std::inserter(found, found.end()), plain_path);
  ::globfree(&files);
  for (const std::string& file : written)
    if (::fnmatch(plain.c_str(), file.c_str(), FNM_PATHNAME | FNM_PERIOD) == 0) found.insert(file);
  std::erase_if(found, [&](const std::string& file) {
    const auto source = made.find(file);
    return source != made.end() && source->second != file;
  });
  if (found.empty()) throw UsageError(fmt::format("{}: no file matches {}", where, word.text));
  return {found.begin(), found.end()};
}

std::string placed(std::string word, const std::string& file) {
  const auto replace = [&](std::string_view mark, const std::string& text) {
    for (std::size_t at = word.find(mark); at != word.npos; at = word.find(mark, at + text.size()))
      word.replace(at, mark.size(), text);
  };
  replace("{stem}", fs::path(file).replace_extension().string());
  replace("{name}", fs::path(file).stem().string());
  return word;
}

struct CommandWords {
  Texts words;
  std::string from;  // The file of this job, or nothing where the line has one job.
};

// The commands that a line stands for.
std::vector<CommandWords> expanded(const Line& line, const std::set<std::string>& written, const Sources& made) {
  const auto pattern = std::ranges::find_if(line.words, &Word::is_pattern);
  const bool each = std::ranges::any_of(line.words, is_place);
  if (pattern == line.words.end() && each)
    throw UsageError(line.where + ": {stem} and {name} need a word such as *.hdr, without quotation marks");
  std::vector<CommandWords> commands;
  if (!each) {
    Texts& all = commands.emplace_back().words;
    for (const Word& word : line.words)
      if (word.is_pattern)
        std::ranges::copy(matching(word, written, made, line.where), std::back_inserter(all));
      else
        all.push_back(word.text);
    return commands;
  }
  for (const std::string& file : matching(*pattern, written, made, line.where)) {
    CommandWords& command = commands.emplace_back(CommandWords{{}, file});
    for (const Word& word : line.words)
      if (!word.is_pattern || is_place(word))
        command.words.push_back(placed(word.text, file));
      else if (word.text == pattern->text)
        command.words.push_back(file);
      else
        std::ranges::copy(matching(word, written, made, line.where), std::back_inserter(command.words));
  }
  return commands;
}

// Parses the words of a job. Nothing is run, and the settings of this process stay.
void parse(const Job& job, Parsed& parsed) {
  Settings unused;
  try {
    tools::parse(job.words, parsed, unused);
  } catch (const HelpRequested&) {
    throw UsageError(job.where + ": asks for help, and writes nothing");
  } catch (const UsageError& e) {
    throw UsageError(job.where + ": " + e.what());
  }
}

void check_writes(const std::string& where, const std::string& name) {
  const auto command = std::ranges::find(commands(), name, &Command::name);
  if (command == commands().end()) return;
  Options options;
  define(*command, options);
  if (const Option* const output = options.output(); output == nullptr || !output->is_argument())
    throw UsageError(fmt::format("{}: {} is not for a batch, which runs commands whose arguments name a file to write",
                                 where, name));
}

const Engine& engine_of(const std::string& where, const Options& options) {
  if (const Engine* const engine = find_engine(options.last("--for"))) return *engine;
  throw UsageError(where + ": needs --for ENGINE");
}

Texts files_of_places(const std::string& where, const std::string& output, const Texts& places) {
  try {
    return place_files(output, places);
  } catch (const UsageError& e) {
    throw UsageError(where + ": " + e.what());
  }
}

Job job_of(const std::string& where, const Texts& words) {
  Job job{where, words, {}, {}};
  check_writes(where, words.front());
  Parsed parsed;
  parse(job, parsed);
  const Options& options = parsed.options;
  const auto add = [](Texts& files, const std::string& name, const std::string& faces) {
    for (const std::string& file : files_of(name, 1, faces)) files.push_back(file == "-" ? file : plain_path(file));
  };
  // The depfile of the job has the names of its rule then.
  const Texts named = options.named(File::output);
  for (std::string& word : job.words)
    if (word != "-" && std::ranges::find(named, word) != named.end()) word = plain_path(word);
  for (const std::string& folder : options.named(File::folder))
    for (const std::string& file : files_of(engine_of(where, options))) add(job.outputs, folder + "/" + file, "");
  const Texts places = options.has("--at") ? parsed.options["--at"].given : Texts{};
  for (const std::string& output : options.named(File::output))
    for (const std::string& name : files_of_places(where, output, places))
      add(job.outputs, name, options.last("--faces"));
  for (const std::string& name : options.named(File::input)) add(job.inputs, name, options.last("--from-faces"));
  if (options.given("--depfile")) throw UsageError(where + ": remove --depfile: a batch has its own");
  if (job.outputs.empty() || is_numbered(job.outputs.front()))
    throw UsageError(where + ": a job of a batch writes files with names of their own, not - and no {frame}");
  return job;
}

std::vector<Job> jobs_of(const Line& line, const std::set<std::string>& written) {
  const auto jobs_beside = [&](const Sources& made) {
    std::vector<std::pair<Job, std::string>> jobs;
    for (const auto& [words, from] : expanded(line, written, made)) jobs.emplace_back(job_of(line.where, words), from);
    return jobs;
  };
  auto jobs = jobs_beside({});
  if (std::ranges::any_of(line.words, &Word::is_pattern)) {
    Sources made;
    for (const auto& [job, from] : jobs)
      for (const std::string& file : job.outputs) made.emplace(file, from);
    jobs = jobs_beside(made);
  }
  std::vector<Job> all;
  for (auto& [job, from] : jobs) all.push_back(std::move(job));
  return all;
}

std::vector<Job> jobs_of(const std::vector<Line>& lines) {
  std::vector<Job> jobs;
  std::map<std::string, std::string> writer;
  std::set<std::string> written;
  for (Line line : lines) {
    if (!line.words.empty() && line.words.front().text == "envmap") line.words.erase(line.words.begin());
    if (line.words.empty()) throw UsageError(line.where + ": holds no command");
    for (const Word& word : line.words)
      if (word.text.find('\0') != word.text.npos)
        throw UsageError(line.where + ": holds a NUL byte, which no argument can");
    for (Job& job : jobs_of(line, written)) {
      for (const std::string& file : job.outputs) {
        const auto [other, is_new] = writer.emplace(file, line.where);
        if (!is_new) throw UsageError(fmt::format("{}: writes {}, as {} does", line.where, file, other->second));
        written.insert(file);
      }
      jobs.push_back(std::move(job));
    }
  }
  return jobs;
}

std::string text_of(const std::string& path) {
  std::error_code error;
  if (path != "-" && fs::is_directory(path, error)) throw InputError(path, "is a folder: give a file name");
  if (path != "-" && !fs::exists(path, error))
    throw InputError(path, "no such manifest: write the lines into a file, or pipe them to 'envmap batch -'");
  std::ifstream file;
  if (path != "-") file.open(path);
  std::ostringstream text;
  text << (path == "-" ? std::cin : file).rdbuf();
  if (text.bad() || (path != "-" && !file.is_open())) throw InputError(path, "cannot be read");
  return text.str();
}

}  // namespace

std::vector<Job> read_manifest(const std::string& path) {
  const std::string text = text_of(path);
  const auto first = text.find_first_not_of(" \t\r\n");
  try {
    std::vector<Job> jobs =
        jobs_of(first != text.npos && text[first] == '[' ? lines_of_json(path, text) : lines_of_text(text));
    if (jobs.empty()) throw InputError(path, "holds no commands");
    check_order(jobs);
    return jobs;
  } catch (const UsageError& e) {
    throw UsageError(path, e.what(), e.remedy());
  }
}

std::vector<Job> bake_jobs(const std::vector<std::string>& probes, const std::string& engine,
                           const std::string& folder) {
  std::vector<Line> lines;
  std::error_code error;
  for (const std::string& probe : probes) {
    if (fs::is_directory(probe, error))
      throw InputError(probe,
                       fmt::format("is a folder: name its files, such as {}", (fs::path(probe) / "*.hdr").string()));
    Line& line = lines.emplace_back(Line{probe, {}});
    for (const std::string& word : {std::string("bake"), probe, (fs::path(folder) / fs::path(probe).stem()).string(),
                                    std::string("--for"), engine})
      line.words.push_back(word_of(word, true));
  }
  return jobs_of(lines);
}

}  // namespace tools
