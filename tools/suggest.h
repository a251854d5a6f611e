// Usage errors in one line, with the word that was probably meant.
#pragma once

#include <CLI/CLI.hpp>
#include <string>

namespace tools {

/// The command of that name, or null.
const CLI::App* find_command(const CLI::App& app, const std::string& name);

std::string explain(const CLI::ParseError& error, const CLI::App& app, int argc, char** argv);

}  // namespace tools
