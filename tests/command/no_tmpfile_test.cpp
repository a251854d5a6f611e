// Outputs where the file system has no files without a name: a temporary file lies beside the output until that is
// whole.
#include <sys/stat.h>

#include <csignal>

#include "picture.h"
#include "run.h"

namespace command_tests {
namespace {

class NoTmpfile : public CommandTest {
 protected:
  const std::string envmap_there = "LD_PRELOAD=" ENVMAP_NO_TMPFILE " \"$ENVMAP\" ";
};

TEST_F(NoTmpfile, OutputsAreTheSame) {
  const std::string make = "generate directions --size 16 ";
  for (const char* name : {"a.exr", "a.hdr", "a.ktx2", "a.png"}) {
    SCOPED_TRACE(name);
    succeeds({"generate", "directions", "--size", "16", "--to", "cube", name});
    const std::string bytes = read(name);
    std::filesystem::remove(path(name));
    const Result r = shell("umask 027; " + envmap_there + make + "--to cube " + name);
    EXPECT_EQ(r.status, 0) << r.err;
    EXPECT_EQ(read(name), bytes);
    struct stat facts = {};
    ::stat(path(name).c_str(), &facts);
    EXPECT_EQ(facts.st_mode & 0777, 0640U);
  }
  const Result piped = shell(envmap_there + make + "--to cube - | cmp - a.exr");
  EXPECT_EQ(piped.status, 0) << piped.out << piped.err;
  EXPECT_EQ(names(), (std::vector<std::string>{"a.exr", "a.hdr", "a.ktx2", "a.png"}));
}

TEST_F(NoTmpfile, NothingIsLeftByASignal) {
  save(path("in.exr"), latlong_directions(8));
  write("out.exr", "the old file");
  const auto before = files();
  for (const int signal : {SIGTERM, SIGINT, SIGHUP, SIGQUIT}) {
    SCOPED_TRACE(signal);
    Background run(*this, {"sh", "-c",
                           "exec env " + envmap_there + "convert in.exr out.exr --to cube --size 2048 --filter area"});
    interrupt(run, signal, [&] { return names().size() > before.size(); });
    EXPECT_EQ(files(), before);
  }
}

}  // namespace
}  // namespace command_tests
