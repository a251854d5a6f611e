#include "run.h"

#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <thread>

namespace command_tests {
namespace {

namespace fs = std::filesystem;

constexpr rlim_t longest_run = 60;  // Seconds of processor time: a run that hangs is a failure, not a stuck suite.

std::string rewound(std::FILE* file) {
  std::string bytes;
  std::rewind(file);
  char block[4096];
  while (const std::size_t n = std::fread(block, 1, sizeof block, file)) bytes.append(block, n);
  return bytes;
}

void limit(int what, rlim_t to) {
  const rlimit both{to, to};
  (void)::setrlimit(static_cast<__rlimit_resource>(what), &both);
}

}  // namespace

std::vector<std::string> split(const std::string& line) {
  std::vector<std::string> words;
  for (std::size_t at = 0; at < line.size();) {
    const std::size_t end = std::min(line.find(' ', at), line.size());
    words.push_back(line.substr(at, end - at));
    at = end + 1;
  }
  return words;
}

std::string bytes_of(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

CommandTest::CommandTest() {
  std::string name = (fs::temp_directory_path() / "envmap-test.XXXXXX").string();
  if (::mkdtemp(name.data()) == nullptr) throw std::runtime_error("no temporary folder for the test");
  root_ = name;
  folder_ = root_ / "work";
  temporary_ = root_ / "temporary";
  fs::create_directory(folder_);
  fs::create_directory(temporary_);
}

CommandTest::~CommandTest() {
  EXPECT_TRUE(fs::is_empty(temporary_)) << "something was left in the temporary folder";
  std::error_code ignored;
  fs::remove_all(root_, ignored);
}

Background::Background(const CommandTest& test, const std::vector<std::string>& arguments, const Setting& setting)
    : in_(std::tmpfile(), std::fclose), out_(std::tmpfile(), std::fclose), err_(std::tmpfile(), std::fclose) {
  if (!in_ || !out_ || !err_) throw std::runtime_error("no temporary files for the run");
  std::fwrite(setting.input.data(), 1, setting.input.size(), in_.get());
  std::rewind(in_.get());
  std::vector<char*> words;
  for (const std::string& a : arguments) words.push_back(const_cast<char*>(a.c_str()));
  words.push_back(nullptr);
  std::fflush(nullptr);

  process_ = ::fork();
  if (process_ < 0) throw std::runtime_error("cannot fork");
  if (process_ > 0) return;
  ::setenv("ENVMAP", ENVMAP_PROGRAM, 1);
  ::setenv("TMPDIR", test.temporary_.c_str(), 1);
  ::dup2(::fileno(in_.get()), STDIN_FILENO);
  ::dup2(::fileno(out_.get()), STDOUT_FILENO);
  ::dup2(::fileno(err_.get()), STDERR_FILENO);
  if (::chdir(test.folder_.c_str()) != 0) ::_exit(126);
  limit(RLIMIT_CORE, 0);
  limit(RLIMIT_CPU, longest_run);
  if (setting.largest_file) {
    // The limit's signal would end the program before it can complain; a full disk sends none.
    std::signal(SIGXFSZ, SIG_IGN);
    limit(RLIMIT_FSIZE, *setting.largest_file);
  }
#ifndef ENVMAP_SANITIZED
  if (setting.memory) limit(RLIMIT_AS, *setting.memory);
#endif
  ::execvp(words[0], words.data());
  ::_exit(127);
}

Background::~Background() {
  if (process_ > 0) wait();
}

void Background::send(int signal) const { ::kill(process_, signal); }

Result Background::wait() {
  int state = 0;
  while (::waitpid(process_, &state, 0) < 0 && errno == EINTR) {
  }
  process_ = -1;
  Result result;
  if (WIFEXITED(state)) result.status = WEXITSTATUS(state);
  if (WIFSIGNALED(state)) result.signal = WTERMSIG(state);
  result.out = rewound(out_.get());
  result.err = rewound(err_.get());
  return result;
}

Result CommandTest::envmap(const std::vector<std::string>& arguments, const Setting& setting) const {
  std::vector<std::string> all{ENVMAP_PROGRAM};
  all.insert(all.end(), arguments.begin(), arguments.end());
  return Background(*this, all, setting).wait();
}

bool Background::writes_in(const std::string& folder) const {
  std::error_code gone;  // The process may end, or close a file, meanwhile.
  for (const auto& open : std::filesystem::directory_iterator("/proc/" + std::to_string(process_) + "/fd", gone)) {
    const std::string file = std::filesystem::read_symlink(open.path(), gone).string();
    if (file.starts_with(folder) && file.ends_with("(deleted)")) return true;
  }
  return false;
}

Result CommandTest::shell(const std::string& line, const Setting& setting) const {
  return Background(*this, {"sh", "-c", line}, setting).wait();
}

nlohmann::json CommandTest::report(const Result& run) {
  EXPECT_EQ(run.status, 0) << run.err;
  return nlohmann::json::parse(run.out, nullptr, false);
}

nlohmann::json CommandTest::report(std::vector<std::string> arguments) const {
  arguments.emplace_back("--json");
  return report(envmap(arguments));
}

void CommandTest::succeeds(const std::vector<std::string>& arguments, const Setting& setting) const {
  SCOPED_TRACE(::testing::PrintToString(arguments));
  const Result r = envmap(arguments, setting);
  EXPECT_EQ(r.status, 0);
  EXPECT_EQ(r.err, "");
}

void CommandTest::fails(int status, const std::vector<std::string>& arguments, const std::vector<std::string>& words,
                        const Setting& setting) const {
  SCOPED_TRACE(::testing::PrintToString(arguments));
  const auto before = files();
  const Result r = envmap(arguments, setting);
  EXPECT_EQ(r.signal, 0);
  EXPECT_EQ(r.status, status);
  EXPECT_EQ(r.out, "");
  EXPECT_EQ(std::ranges::count(r.err, '\n'), 1) << r.err;
  EXPECT_TRUE(r.err.starts_with("envmap " + arguments.at(0) + ": ")) << r.err;
  for (const std::string& word : words)
    EXPECT_NE(r.err.find(word), std::string::npos) << "no '" << word << "' in: " << r.err;
  EXPECT_TRUE(files() == before) << "files were left or changed: " << ::testing::PrintToString(names());
}

void CommandTest::write(const std::string& name, const std::string& bytes) const {
  std::ofstream(path(name), std::ios::binary) << bytes;
}

std::string CommandTest::read(const std::string& name) const { return bytes_of(folder_ / name); }

std::map<std::string, std::string> CommandTest::files() const {
  std::map<std::string, std::string> all;
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(folder_)) {
    const std::string name = fs::relative(entry.path().parent_path(), folder_) / entry.path().filename();
    const std::string plain = name.starts_with("./") ? name.substr(2) : name;
    if (entry.is_symlink())
      all[plain + "@"] = fs::read_symlink(entry.path()).string();
    else if (entry.is_directory())
      all[plain + "/"] = "";
    else
      all[plain] = bytes_of(entry.path());
  }
  return all;
}

std::vector<std::string> CommandTest::names() const {
  std::vector<std::string> all;
  for (const auto& [name, bytes] : files()) all.push_back(name);
  return all;
}

void interrupt(Background& run, int signal, const std::function<bool()>& writes) {
  for (int k = 0; k < 500 && !writes(); ++k) std::this_thread::sleep_for(std::chrono::milliseconds(20));
  EXPECT_TRUE(writes()) << "the run never began to write";
  run.send(signal);
  EXPECT_EQ(run.wait().signal, signal);
}

}  // namespace command_tests
