#include <fmt/format.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <thread>

#include "command.h"
#include "commands/batch/manifest.h"
#include "commands/batch/schedule.h"
#include "envmap/base/error.h"
#include "envmap/base/system.h"
#include "maps/read_and_write_maps.h"

namespace tools {
namespace {

using namespace envmap;
namespace fs = std::filesystem;

struct Request {
  std::vector<std::string> names;
  std::string engine, into = ".", make, slurm;
  int at_once = 0;
  bool keep_going = false;
};

std::string this_program() {
  const fs::path program = own_program();
  if (program.empty()) throw InputError("/proc/self/exe", "the system does not tell where envmap lies: mount /proc");
  return program.string();
}

bool is_installed(const std::string& program) {
  const char* const path = std::getenv("PATH");
  for (const std::string& folder : split(path != nullptr ? path : "/usr/bin:/bin", ':'))
    if (::access((fs::path(folder) / program).c_str(), X_OK) == 0) return true;
  return false;
}

constexpr char status_mark = '\x01';  // Begins Ninja's lines of progress, by NINJA_STATUS.

// What Ninja prints, as it comes: a line of progress, one line for each job that failed, and what jobs say.
class NinjaOutput {
 public:
  NinjaOutput() : show_(!settings().quiet && ::isatty(STDERR_FILENO) != 0) {}

  void take(const std::string& line) {
    if (line.starts_with(status_mark)) {
      finish_failure();
      int all = 0;
      if (std::sscanf(line.c_str() + 1, "[%d/%d]", &finished_, &all) == 2) left_ = all - finished_;
      if (show_) std::fputs(("\r" + printable(line.substr(1, columns)) + "\033[K").c_str(), stderr);
      dirty_ = show_;
    } else if (line.starts_with("FAILED: ")) {
      finish_failure();
      failed_ = line.substr(8);
      // From 1.13 on, Ninja begins with '[code=N] '.
      if (failed_.starts_with("[code=")) failed_.erase(0, failed_.find(' ') + 1);
      after_ = 0;
    } else if (line.starts_with("ninja: error: ")) {
      finish_failure();
      say("envmap batch: " + line.substr(7));
    } else if (line.starts_with("ninja: ")) {
      finish_failure();
      if (line.find("no work to do") != line.npos) note("envmap batch: nothing to do");
    } else if (!failed_.empty()) {
      if (after_++ > 0 && !line.empty()) said_ = line;  // The first is the command.
    } else if (!line.empty()) {
      say(line);
    }
  }
  void end() {
    finish_failure();
    clear();
  }
  [[nodiscard]] int failures() const { return failures_; }
  [[nodiscard]] int finished() const { return finished_; }
  [[nodiscard]] int skipped() const { return left_; }

 private:
  static constexpr std::size_t columns = 78;
  void clear() {
    if (dirty_) std::fputs("\r\033[K", stderr);
    dirty_ = false;
  }
  void say(const std::string& line) {
    clear();
    warn(line);
  }
  void finish_failure() {
    if (failed_.empty()) return;
    while (failed_.ends_with(' ')) failed_.pop_back();
    say(fmt::format("envmap batch: not made: {}: {}", failed_, said_.empty() ? "ended without a word" : said_));
    ++failures_;
    failed_.clear(), said_.clear();
  }

  bool show_, dirty_ = false;
  std::string failed_, said_;
  int after_ = 0, failures_ = 0, finished_ = 0, left_ = 0;
};

// @return its exit status.
int run_ninja(const std::string& file, const Request& o, std::size_t jobs, NinjaOutput& output) {
  const auto cores = std::size_t(std::max(1U, std::thread::hardware_concurrency()));
  const std::size_t at_once = o.at_once > 0 ? std::size_t(o.at_once) : std::min(cores, jobs);
  const std::size_t threads =
      settings().threads > 0 ? std::size_t(settings().threads) : std::max<std::size_t>(1, cores / at_once);
  ::setenv("ENVMAP_THREADS", std::to_string(threads).c_str(), 1);
  ::setenv("NINJA_STATUS", fmt::format("{}[%f/%t] ", status_mark).c_str(), 1);
  const std::string line =
      fmt::format("exec ninja -f {} -j {}{} 2>&1", quoted(file), at_once, o.keep_going ? " -k 0" : "");
  std::fflush(nullptr);
  std::FILE* const pipe = ::popen(line.c_str(), "r");
  if (pipe == nullptr) throw OutputError("ninja cannot be started");
  std::string text;
  for (int c = 0; (c = std::fgetc(pipe)) != EOF;)
    if (c != '\n')
      text += static_cast<char>(c);
    else
      output.take(text), text.clear();
  if (!text.empty()) output.take(text);
  output.end();
  return ::pclose(pipe);
}

std::vector<Job> jobs_of(const Request& o) {
  if (!o.engine.empty()) return bake_jobs(o.names, o.engine, o.into);
  if (o.names.size() > 1) throw UsageError(o.names[1], "give one manifest, or --for ENGINE and probes");
  return read_manifest(o.names.front());
}

// By the path of the manifest: several of a project have the same name.
std::string state_folder(const Request& o) {
  const std::string path = o.engine.empty() ? o.names.front() : (fs::path(o.into) / o.engine).string();
  std::string name = path == "-" ? "standard-input" : plain_path(path);
  constexpr std::string_view special = "/;=%|()*?[\\";  // Make has no way to write most of them.
  std::ranges::replace_if(
      name, [&](char c) { return special.find(c) != special.npos; }, '+');
  return ".envmap-batch/" + name;
}

void tell(int finished, int jobs) {
  if (finished > 0)
    note(
        fmt::format("envmap batch: {} job{} done, {} up to date", finished, finished == 1 ? "" : "s", jobs - finished));
}

int run(const Request& o, const Options& options) {
  if (!o.make.empty() && !o.slurm.empty()) throw UsageError("--make and --slurm: one of them");
  if ((!o.make.empty() || !o.slurm.empty()) && (o.at_once > 0 || o.keep_going))
    throw UsageError("--make and --slurm run nothing: give -j and -k to make, and the like to sbatch");
  if ((!o.make.empty() || !o.slurm.empty()) && options.on_command_line("--threads"))
    throw UsageError(o.make.empty() ? "--threads: --slurm runs nothing: give --cpus-per-task to sbatch"
                                    : "--threads: --make runs nothing: set ENVMAP_THREADS for make");
  const std::vector<Job> jobs = jobs_of(o);
  const std::string folder = state_folder(o);
  if (!o.slurm.empty() || !o.make.empty()) {
    const std::string& path = o.slurm.empty() ? o.make : o.slurm;
    write_text(path, o.slurm.empty() ? makefile(jobs, this_program(), folder) : slurm_script(jobs, this_program()));
    note(fmt::format("{}: {} job{}", path, jobs.size(), jobs.size() == 1 ? "" : "s"));
    return 0;
  }
  if (!is_installed("ninja")) throw OutputError("ninja is not installed: install ninja-build, or use --make FILE");
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) throw OutputError(folder, error.message());
  const std::string file = folder + "/build.ninja";
  write_text(file, ninja_file(jobs, this_program(), folder));
  NinjaOutput output;
  const int status = run_ninja(file, o, jobs.size(), output);
  if (status == 0) {
    tell(output.finished(), int(jobs.size()));
    return 0;
  }
  if (WIFSIGNALED(status)) throw OutputError("ninja was ended by a signal");
  if (jobs.size() == 1) throw OutputError("the job failed");
  std::string skipped;
  if (output.skipped() > 0)
    skipped =
        fmt::format("; skipped {} that {}", output.skipped(),
                    o.keep_going ? "needed outputs of failed jobs" : "had not started (-k continues after failures)");
  throw OutputError(fmt::format("{} of {} jobs failed{}", output.failures(), jobs.size(), skipped));
}

}  // namespace

Action define_batch(Options& o) {
  const auto r = std::make_shared<Request>();
  o.files(r->names, File::input,
          "Manifest, or '-' for stdin; with --for, probes. For a/b.hdr, {stem} in a line is a/b and {name} is b");
  o.group = "Jobs";
  o.add("--for", "ENGINE", &r->engine, "Bake probes for this engine ('envmap bake --list' lists engines)");
  o.add("--into", "FOLDER", &r->into, "Parent folder of the baked folders (default: the current one)").needs = "--for";
  o.add("-j,--jobs", "N", &r->at_once, {1, 1024}, "Jobs at once (default: the number of cores)");
  o.flag("-k,--keep-going", r->keep_going, "Continue after a job that failed");
  o.group = "Other schedulers";
  o.add("--make", "FILE", &r->make, "Write a Makefile, and run nothing").file = File::output;
  o.add("--slurm", "FILE", &r->slurm, "Write a script for Slurm's sbatch, and run nothing").file = File::output;
  return [r, &o](Report&) { return run(*r, o); };
}

}  // namespace tools
