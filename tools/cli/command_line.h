// The program's command line. Only command_line.cpp includes CLI11.
#pragma once

#include <string>
#include <vector>

#include "command.h"

namespace tools {

/// Thrown where the command line asks for a text and nothing else: --help, --version, a list. The exit status is 0.
struct HelpRequested {
  std::string text;
};

/// A command with the values of its options. Its action refers to the options: it cannot be copied.
struct Parsed {
  const Command* command = nullptr;
  Options options;
  Action action;

  Parsed() = default;
  Parsed(const Parsed&) = delete;
  Parsed& operator=(const Parsed&) = delete;
};

/// @param words without the program's name. @param settings receives the options that every command has.
/// @throws UsageError in one line, with the word that was probably meant; HelpRequested.
void parse(const std::vector<std::string>& words, Parsed& parsed, Settings& settings = tools::settings());

/// Checks the files that are named, runs the action, writes the depfile and prints the report. @return the exit status.
int run(Parsed& parsed);

/// What --version --json prints: version, commit, libraries and renderer, as JSON.
std::string version_json();
/// What --version prints: the version, the commit where it is known, the libraries.
std::string version_text();

/// What draws with --context auto, or why nothing does.
std::string renderer_text();

}  // namespace tools
