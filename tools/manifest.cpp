#include "manifest.h"

#include <fmt/format.h>
#include <fnmatch.h>
#include <glob.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <iterator>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>

#include "command.h"
#include "envmap/base/error.h"
#include "named_files.h"
#include "suggest.h"

namespace tools {
namespace {

using namespace envmap;
namespace fs = std::filesystem;
using Words = std::vector<std::string>;

struct Line {
  std::string where;
  Words words;
};

// A line as a shell cuts it: '...' as it stands, "..." and what follows a backslash without its meaning, # begins a comment.
Words split(const std::string& line, const std::string& where) {
  Words words;
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
    else if (c == '\\' && quote != '\'' && k + 1 < line.size())
      words.back() += line[++k];
    else
      words.back() += c;
  }
  if (quote != 0) throw UsageError(fmt::format("{}: a quotation mark {} is not closed", where, quote));
  return words;
}

std::vector<Line> lines_of_json(const std::string& path, const std::string& text) {
  const auto json = nlohmann::json::parse(text, nullptr, false);
  if (!json.is_array()) throw InputError(path, "is no JSON array of commands");
  std::vector<Line> lines;
  for (const auto& job : json) {
    Line line{fmt::format("job {}", lines.size() + 1), {}};
    if (job.is_string())
      line.words = split(job.get<std::string>(), line.where);
    else if (job.is_array() && std::ranges::all_of(job, [](const auto& word) { return word.is_string(); }))
      line.words = job.get<Words>();
    else
      throw InputError(path, fmt::format("{} is neither a command line nor an array of words", line.where));
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
    if (const Words words = split(line, where); !words.empty()) lines.push_back({where, words});
  }
  return lines;
}

bool is_pattern(const std::string& word) { return word.find_first_of("*?[") != word.npos; }
bool is_place(const std::string& word) { return word.find("{stem}") != word.npos || word.find("{name}") != word.npos; }

Words matching(const std::string& pattern, const std::set<std::string>& written, const std::string& where) {
  std::set<std::string> found;
  glob_t files = {};
  if (::glob(pattern.c_str(), 0, nullptr, &files) == 0) found.insert(files.gl_pathv, files.gl_pathv + files.gl_pathc);
  ::globfree(&files);
  for (const std::string& file : written)
    if (::fnmatch(pattern.c_str(), file.c_str(), FNM_PATHNAME) == 0) found.insert(file);
  if (found.empty()) throw UsageError(fmt::format("{}: no file matches {}", where, pattern));
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

// The commands that a line stands for.
std::vector<Words> expanded(const Line& line, const std::set<std::string>& written) {
  const auto pattern = std::ranges::find_if(line.words, is_pattern);
  const bool each = std::ranges::any_of(line.words, is_place);
  if (pattern == line.words.end() && each) throw UsageError(line.where + ": {stem} and {name} need a word such as *.hdr");
  Words all;
  if (!each) {
    for (const std::string& word : line.words)
      if (is_pattern(word))
        std::ranges::copy(matching(word, written, line.where), std::back_inserter(all));
      else
        all.push_back(word);
    return {all};
  }
  std::vector<Words> commands;
  for (const std::string& file : matching(*pattern, written, line.where)) {
    Words& words = commands.emplace_back();
    for (const std::string& word : line.words) words.push_back(word == *pattern ? file : placed(word, file));
  }
  return commands;
}

constexpr std::array with_output{"bake", "convert", "generate", "merge", "mipmap", "prefilter", "preview", "render", "view"};

// What the command's own definition makes of its words; no command is run.
void parse(Program& program, const Job& job) {
  Words reversed(job.words.rbegin(), job.words.rend());
  try {
    program.app->parse(reversed);
  } catch (const CLI::Success&) {
    throw UsageError(job.where + ": asks for help, and writes nothing");
  } catch (const CLI::ParseError& e) {
    std::vector<char*> arguments{const_cast<char*>("envmap")};
    for (const std::string& word : job.words) arguments.push_back(const_cast<char*>(word.c_str()));
    throw UsageError(job.where + ": " + explain(e, *program.app, static_cast<int>(arguments.size()), arguments.data()));
  }
}

Job job_of(Program& program, const std::string& where, const Words& words) {
  Job job{where, words, {}, {}};
  const std::string& command = words.front();
  if (find_command(*program.app, command) != nullptr && std::ranges::find(with_output, command) == with_output.end())
    throw UsageError(fmt::format("{}: {} writes no file that a batch could look after", where, command));
  parse(program, job);
  Words names;
  const CLI::App& app = *program.app->get_subcommand(command);
  for (const CLI::Option* option : app.get_options())
    if (option->get_positional()) std::ranges::copy(option->results(), std::back_inserter(names));
  if (command == "generate" && !names.empty()) names.erase(names.begin());  // Its kind.
  if (!names.empty()) {
    std::string output = names.back();
    names.pop_back();
    if (command == "bake") output += "/README.txt";
    job.outputs = files_of(output, 1);
  }
  if (const CLI::Option* table = app.get_option_no_throw("--brdf-table"); table != nullptr && table->count() > 0)
    job.outputs.push_back(table->results().front());
  if (app.get_option("--depfile")->count() > 0) throw UsageError(where + ": leave out --depfile: a batch has its own");
  if (job.outputs.empty() || job.outputs.front().find("{frame") != std::string::npos)
    throw UsageError(where + ": a job of a batch writes files with names of their own, not - and no {frame}");
  for (const std::string& name : names) std::ranges::copy(files_of(name, 1), std::back_inserter(job.inputs));
  return job;
}

std::vector<Job> jobs_of(const std::vector<Line>& lines) {
  Program program;
  std::vector<Job> jobs;
  std::map<std::string, std::string> writer;
  std::set<std::string> written;
  for (Line line : lines) {
    if (!line.words.empty() && line.words.front() == "envmap") line.words.erase(line.words.begin());
    if (line.words.empty()) throw UsageError(line.where + ": holds no command");
    for (const std::string& word : line.words)
      if (word.find('\0') != word.npos) throw UsageError(line.where + ": holds a NUL byte, which no argument can");
    for (const Words& words : expanded(line, written)) {
      Job job = job_of(program, line.where, words);
      for (const std::string& file : job.outputs) {
        if (!writer.emplace(file, line.where).second)
          throw UsageError(fmt::format("{}: writes {}, as {} does", line.where, file, writer[file]));
        written.insert(file);
      }
      jobs.push_back(std::move(job));
    }
  }
  return jobs;
}

std::string text_of(const std::string& path) {
  if (path != "-" && fs::is_directory(path)) throw InputError(path, "is a folder; name a file");
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
  std::vector<Job> jobs = jobs_of(first != text.npos && text[first] == '[' ? lines_of_json(path, text) : lines_of_text(text));
  if (jobs.empty()) throw InputError(path, "holds no commands");
  return jobs;
}

std::vector<Job> bake_jobs(const std::vector<std::string>& probes, const std::string& engine, const std::string& folder) {
  std::vector<Line> lines;
  for (const std::string& probe : probes)
    lines.push_back({probe, {"bake", probe, (fs::path(folder) / fs::path(probe).stem()).string(), "--for", engine}});
  return jobs_of(lines);
}

}  // namespace tools
