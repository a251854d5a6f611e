// What --depfile says an output depends on, and that make and ninja believe it.
#include <chrono>
#include <filesystem>

#include "picture.h"
#include "run.h"

namespace command_tests::depfile_test {
namespace {

namespace fs = std::filesystem;

class Depfile : public CommandTest {
 protected:
  Depfile() { save(path("in.exr"), latlong_directions(4)); }
};

TEST_F(Depfile, NamesOutputAndInputs) {
  succeeds({"convert", "in.exr", "out.exr", "--depfile", "out.d"});
  EXPECT_EQ(read("out.d"), "out.exr: in.exr\nin.exr:\n");
  succeeds({"convert", "in.exr", "f_{face}.exr", "--to", "cube", "--depfile", "out.d"});
  EXPECT_EQ(read("out.d"), "f_px.exr f_nx.exr f_py.exr f_ny.exr f_pz.exr f_nz.exr: in.exr\nin.exr:\n");
  succeeds({"convert", "f_{face}.exr", "out.exr", "--depfile", "out.d"});
  EXPECT_EQ(read("out.d"), "out.exr: f_px.exr f_nx.exr f_py.exr f_ny.exr f_pz.exr f_nz.exr\n"
                           "f_px.exr:\nf_nx.exr:\nf_py.exr:\nf_ny.exr:\nf_pz.exr:\nf_nz.exr:\n");
  succeeds({"preview", "in.exr", "out.exr", "out.png", "--depfile", "out.d"});
  EXPECT_EQ(read("out.d"), "out.png: in.exr out.exr\nin.exr:\nout.exr:\n");
}

TEST_F(Depfile, NamesBothMapsOfACompare) {
  const Result r = envmap({"compare", "in.exr", "in.exr", "--difference", "d.exr", "--depfile", "d.d"});
  EXPECT_EQ(r.status, 0) << r.err;
  EXPECT_EQ(read("d.d"), "d.exr: in.exr\nin.exr:\n");
}

TEST_F(Depfile, IsReadByMakeAndNinjaWhateverTheNames) {
  const std::vector<std::string> odd{"my map$1#2.exr", "c:d.exr", "e\\f.exr", "g\\ h.exr"};
  for (const std::string& name : odd) {
    SCOPED_TRACE(name);
    fs::copy_file(path("in.exr"), path(name));
    succeeds({"convert", name, "out.exr", "--depfile", "out.d"});
    // As GCC has it, but for the colon, which GCC forgets.
    if (name == odd[0]) {
      EXPECT_EQ(read("out.d"), "out.exr: my\\ map$$1\\#2.exr\nmy\\ map$$1\\#2.exr:\n");
    } else if (name == odd[3]) {
      EXPECT_EQ(read("out.d"), "out.exr: g\\\\\\ h.exr\ng\\\\\\ h.exr:\n");
    }
    if (shell("command -v make").status == 0) {
      write("Makefile", "all: out.exr\nout.exr: ; @echo made\n-include out.d\n");
      EXPECT_EQ(shell("touch -d tomorrow out.exr && make -s").out, "");
      fs::last_write_time(path(name), fs::last_write_time(path("out.exr")) + std::chrono::hours(1));
      EXPECT_EQ(shell("make -s").out, "made\n") << "a newer input is seen under its name";
      fs::remove(path(name));
      EXPECT_EQ(shell("make -s").status, 0) << "an input that is gone does not stop make";
      fs::copy_file(path("in.exr"), path(name));
    }
    write("build.ninja",
          "rule r\n  command = cp in.exr out.exr; cp out.d kept.d; touch made\n  depfile = kept.d\nbuild out.exr: r\n");
    fs::remove(path("kept.d"));
    ASSERT_EQ(shell("ninja").status, 0);
    fs::remove(path("made"));
    ASSERT_EQ(shell("ninja && test ! -e made").status, 0);
    fs::last_write_time(path(name), fs::last_write_time(path("out.exr")) + std::chrono::hours(1));
    EXPECT_EQ(shell("ninja && test -e made").status, 0);
  }
}

TEST_F(Depfile, IsRefusedWhereNothingIsWritten) {
  fails(2, {"compare", "in.exr", "in.exr", "--depfile", "out.d"}, {"--depfile", "--difference"});
  fails(2, {"sh", "in.exr", "--depfile", "out.d"}, {"--depfile", "--evaluate"});
  const Result r = envmap({"convert", "in.exr", "-", "--depfile", "out.d"});
  EXPECT_EQ(r.status, 2);
}

TEST_F(Depfile, IsNotWrittenForARunThatFails) {
  fails(3, {"convert", "missing.exr", "out.exr", "--depfile", "out.d"}, {"missing.exr"});
}

// Else make would take the output for up to date.
TEST_F(Depfile, ThatCannotBeWrittenLeavesNoOutput) {
  for (const std::string name : {"out.exr", "out_{face}.exr", "out.ktx2"})
    fails(4, {"convert", "in.exr", name, "--to", "cube", "--depfile", "/dev/full"}, {"/dev/full"});
  write("out.exr", "old");
  fails(4, {"mipmap", "in.exr", "out.exr", "--depfile", "/dev/full"}, {"/dev/full"});
}

TEST_F(Depfile, NamesEveryFrameAndAllThatASceneIsMadeOf) {
  write("scene.obj", "mtllib some.mtl none.mtl\nv 0 0 -1\nv 1 0 -1\nv 0 1 -1\nvt 0 0\nusemtl m\nf 1/1 2/1 3/1\n");
  write("some.mtl", "newmtl m\nmap_Kd in.exr\n");
  succeeds({"generate", "sky", "sky.exr", "--size", "128"});
  const Result r = envmap({"render", "scene.obj", "{frame}.exr", "--environment", "sky.exr", "--frames", "0:1",
                           "--size", "4", "--method", "raycast", "--depfile", "out.d", "-q"});
  ASSERT_EQ(r.status, 0) << r.err;
  EXPECT_EQ(r.err, "scene.obj: 'none.mtl' is missing: its materials are white\n");  // Whatever --quiet.
  EXPECT_EQ(read("out.d"), "0000.exr 0001.exr: scene.obj some.mtl in.exr sky.exr\n"
                           "scene.obj:\nsome.mtl:\nin.exr:\nsky.exr:\n");
  // Every output is known before any is written.
  write("scene.obj", "mtllib some.mtl\nv 0 0 -1\nv 1 0 -1\nv 0 1 -1\nvt 0 0\nusemtl m\nf 1/1 2/1 3/1\n");
  fails(2, {"render", "scene.obj", "%d.exr", "--frames", "1:2", "--depfile", "2.exr"}, {"2.exr", "twice"});
  fails(2, {"render", "scene.obj", "in.exr"}, {"in.exr", "both input and output"});
}

TEST_F(Depfile, NamesTheTableOfThePrefilter) {
  const std::vector<std::string> table{"--brdf-table", "brdf.exr", "--table-size", "4", "--depfile", "out.d"};
  std::vector<std::string> arguments{"prefilter"};
  arguments.insert(arguments.end(), table.begin(), table.end());
  succeeds(arguments);
  EXPECT_EQ(read("out.d"), "brdf.exr:\n");
  arguments.insert(arguments.end(), {"in.exr", "{level}.hdr", "--lobe", "ggx", "--levels", "2", "--size", "4", "-q"});
  succeeds(arguments);
  EXPECT_EQ(read("out.d"), "0.hdr 1.hdr brdf.exr: in.exr\nin.exr:\n");
  fails(2, {"prefilter", "in.exr", "out.exr", "--brdf-table", "in.exr"}, {"in.exr", "both input and output"});
  fails(2, {"prefilter", "in.exr", "out.exr", "--brdf-table", "out.exr"}, {"out.exr", "twice"});
}

}  // namespace
}  // namespace command_tests::depfile_test
