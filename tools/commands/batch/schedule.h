// Jobs as the files of engines that schedule them.
#pragma once

#include <span>
#include <string>

#include "commands/batch/manifest.h"

namespace tools {

/// One name for each file, as jobs know it: relative to the current folder where it is near, without ./ and the like.
std::string plain_path(const std::string& path);

/// @throws UsageError where jobs wait for each other in a circle, with the lines at fault.
void check_order(std::span<const Job> jobs);

/// @param program the path of envmap. @param folder for what the engine keeps: depfiles, Ninja's log.
std::string ninja_file(std::span<const Job> jobs, const std::string& program, const std::string& folder);
std::string makefile(std::span<const Job> jobs, const std::string& program, const std::string& folder);

/// A script that is an array job, and that submits itself when it is run by sh: jobs that read what others write come
/// in an array of their own that waits for these.
std::string slurm_script(std::span<const Job> jobs, const std::string& program);

/// A word as sh takes it for one word.
std::string quoted(const std::string& word);

}  // namespace tools
