#include <fmt/format.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <thread>

#include "command.h"
#include "envmap/base/error.h"
#include "manifest.h"
#include "schedule.h"

namespace tools {
namespace {

using namespace envmap;
namespace fs = std::filesystem;

struct Options {
  std::vector<std::string> names;
  std::string engine, into = ".", make, slurm;
  int at_once = 0;
  bool keep_going = false;
};

std::string this_program() { return fs::read_symlink("/proc/self/exe").string(); }

bool is_installed(const std::string& program) {
  const char* const path = std::getenv("PATH");
  for (const std::string& folder : CLI::detail::split(path != nullptr ? path : "/usr/bin:/bin", ':'))
    if (::access((fs::path(folder) / program).c_str(), X_OK) == 0) return true;
  return false;
}

constexpr char status_mark = '\x01';  // Begins Ninja's lines of progress, by NINJA_STATUS.

// What Ninja prints, as it comes: a line of progress, one line for each job that failed, and what jobs say.
class NinjaOutput {
 public:
  explicit NinjaOutput(const Common& common) : common_(common), show_(!common.quiet && ::isatty(STDERR_FILENO) != 0) {}

  void take(const std::string& line) {
    if (line.starts_with(status_mark)) {
      finish_failure();
      if (show_) std::fputs(("\r" + printable(line.substr(1, columns)) + "\033[K").c_str(), stderr);
      dirty_ = show_;
    } else if (line.starts_with("FAILED: ")) {
      finish_failure();
      failed_ = line.substr(8);
      after_ = 0;
    } else if (line.starts_with("ninja: error: ")) {
      finish_failure();
      say("envmap batch: " + line.substr(7));
    } else if (line.starts_with("ninja: ")) {
      finish_failure();
      if (line.find("no work to do") != line.npos) note(common_, "envmap batch: nothing to do");
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

  const Common& common_;
  bool show_, dirty_ = false;
  std::string failed_, said_;
  int after_ = 0, failures_ = 0;
};

// @return its exit status.
int run_ninja(const std::string& file, const Options& o, std::size_t jobs, const Common& common, NinjaOutput& output) {
  const auto cores = static_cast<std::size_t>(std::max(1U, std::thread::hardware_concurrency()));
  const std::size_t at_once = o.at_once > 0 ? static_cast<std::size_t>(o.at_once) : std::min(cores, jobs);
  const std::size_t threads = common.threads > 0 ? static_cast<std::size_t>(common.threads) : std::max<std::size_t>(1, cores / at_once);
  ::setenv("ENVMAP_THREADS", std::to_string(threads).c_str(), 1);
  ::setenv("NINJA_STATUS", fmt::format("{}[%f/%t] ", status_mark).c_str(), 1);
  const std::string line = fmt::format("exec ninja -f {} -j {}{} 2>&1", quoted(file), at_once, o.keep_going ? " -k 0" : "");
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

std::vector<Job> jobs_of(const Options& o) {
  if (!o.engine.empty()) return bake_jobs(o.names, o.engine, o.into);
  if (o.names.size() > 1) throw UsageError(o.names[1], "one manifest, or --for ENGINE and probes");
  return read_manifest(o.names.front());
}

int run(const Options& o, const Common& common) {
  if (!o.make.empty() && !o.slurm.empty()) throw UsageError("--make and --slurm: one of them");
  const std::vector<Job> jobs = jobs_of(o);
  const std::string name = !o.engine.empty() ? o.engine : fs::path(o.names.front()).stem().string();
  const std::string folder = ".envmap-batch/" + (name == "-" ? "standard-input" : name);
  if (!o.slurm.empty() || !o.make.empty()) {
    const std::string& path = o.slurm.empty() ? o.make : o.slurm;
    write_text(path, o.slurm.empty() ? makefile(jobs, this_program(), folder) : slurm_script(jobs, this_program()), common.commit);
    note(common, fmt::format("{}: {} jobs", path, jobs.size()));
    return 0;
  }
  if (!is_installed("ninja")) throw OutputError("ninja is not installed: install ninja-build, or say --make FILE");
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) throw OutputError(folder, error.message());
  const std::string file = folder + "/build.ninja";
  write_text(file, ninja_file(jobs, this_program(), folder), common.commit);
  NinjaOutput output(common);
  const int status = run_ninja(file, o, jobs.size(), common, output);
  if (status == 0) return 0;
  if (WIFSIGNALED(status)) throw OutputError("ninja was ended by a signal");
  throw OutputError(fmt::format("{} of {} jobs failed{}", output.failures(), jobs.size(),
                                o.keep_going ? "" : "; what was not begun then is not made (-k goes on)"));
}

}  // namespace

Command batch_command() {
  return {
      .name = "batch",
      .summary = "Run many commands through Ninja, Make or Slurm, each again only where something changed",
      .description =
          "Takes a manifest of commands of this program and leaves the work to an engine that schedules: Ninja runs them, several "
          "at once, after what they read of each other; what did not change is not made again (depfiles; a changed command "
          "counts). --make writes a Makefile instead, --slurm a script of array jobs.\n\n"
          "A manifest holds a command a line, with or without 'envmap' before it, quoted as in a shell; # begins a comment. Or it "
          "is JSON: an array of commands, each a line or an array of words. All commands are checked before the first runs. A "
          "word with * ? or [ stands for the files that match, or that earlier lines write: where another word of the line has "
          "{stem}, the file's path without the extension, or {name}, without the folder too, each file is a job of its own; else "
          "all are words of one job. Names are seen from the current folder, whose .envmap-batch keeps what Ninja remembers.\n\n"
          "--for ENGINE takes probes instead of a manifest, and bakes each into a folder of its name.\n\n"
          "A job that fails is named in one line; without -k no other is begun then. The exit status is 4 where one failed. As "
          "many jobs as there are cores run at once, with threads for the rest of the cores; ENVMAP_THREADS is how many a job "
          "takes that has no --threads.\n\n"
          "--slurm: 'sh FILE --mem=2G' submits one array job, or one after another where jobs read what others write; options go "
          "to sbatch. A job that is killed leaves nothing behind and can be queued again. One large job is divided by --shard: "
          "see envmap-merge(1).",
      .examples = {{"envmap batch maps.txt", "with the line 'mipmap *.hdr {stem}.ktx2 --depth half': a texture of every probe"},
                   {"envmap batch maps.json -k", "go on after failures"},
                   {"envmap batch --for three *.hdr --into lights", "lights/NAME for each NAME.hdr"},
                   {"envmap batch maps.txt --slurm maps.sh && sh maps.sh --cpus-per-task=4 --mem=2G", "on a cluster"}},
      .define = [](CLI::App& app, const Common& common) -> std::function<int()> {
        auto o = std::make_shared<Options>();
        app.add_option("FILES", o->names, "The manifest, '-' for standard input; with --for, probes")->required()->type_name("");
        app.add_option("--for", o->engine, "Bake the probes for this engine: see 'envmap bake --list'")->type_name("ENGINE");
        app.add_option("--into", o->into, "Folder of the folders that --for makes (default: this one)")->type_name("FOLDER");
        app.add_option("-j,--jobs", o->at_once, "Jobs at once (default: as many as there are cores)")->type_name("N")->check(CLI::Range(1, 1024));
        app.add_flag("-k,--keep-going", o->keep_going, "Go on after a job that failed");
        app.add_option("--make", o->make, "Write a Makefile, and run nothing")->type_name("FILE");
        app.add_option("--slurm", o->slurm, "Write a script for Slurm's sbatch, and run nothing")->type_name("FILE");
        return [o, &common] { return run(*o, common); };
      }};
}

}  // namespace tools
