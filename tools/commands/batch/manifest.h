// What a batch is to do: command lines, checked, with the files that each reads and writes.
#pragma once

#include <string>
#include <vector>

namespace tools {

struct Job {
  std::string where;               ///< "line 3", "job 3": for messages.
  std::vector<std::string> words;  ///< Of the command, without the program's name.
  /// That its arguments name. The outputs of a baked folder are all of its files.
  std::vector<std::string> inputs, outputs;
};

/// The jobs of a file: JSON, an array of commands, each an array of words or a line; or else a command a line, quoted
/// as in a shell, with comments from # on. A word with an unquoted * ? or [ stands for the files that match
/// it: those that are there and those that earlier lines write, but none that its own line makes of another. For each
/// of them there is a job of its own where another word has {stem} (its path without the extension) or {name} (without
/// the folder, too), else they are words of one job. @param path '-' for standard input.
/// @throws UsageError where a command is wrong, or two jobs write the same file; InputError where it cannot be read.
std::vector<Job> read_manifest(const std::string& path);

/// `bake` of every probe into FOLDER/NAME.
std::vector<Job> bake_jobs(const std::vector<std::string>& probes, const std::string& engine,
                           const std::string& folder);

}  // namespace tools
