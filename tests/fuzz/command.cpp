// The program in one process, but for main(): an exception that is no Error is what main() calls a fault of envmap.
#include <algorithm>
#include <fstream>
#include <string>
#include <vector>

#include "cli/command_line.h"
#include "commands/batch/manifest.h"
#include "envmap/base/error.h"
#include "maps/read_and_write_maps.h"
#include "sound_scene.h"
#include "targets.h"

using namespace envmap;

namespace {

using Words = std::vector<std::string>;

const std::string image = "fuzz_command.tga";  // Targa alone goes by the name.

// Of small outputs: what is large is refused, not waited for.
const std::vector<Words>& commands_of_images() {
  static const std::vector<Words> all{
      {"info", image, "--json"},
      {"convert", image, "fuzz_command.exr", "--to", "cube", "--size", "3"},
      {"convert", image, "fuzz_command.hdr", "--to", "latlong", "--size", "4", "--repair", "--clamp",
       "--drop-channels"},
      {"convert", image, "fuzz_command.env", "--to", "cube", "--size", "4", "--repair", "--clamp", "--drop-channels"},
      {"mipmap", image, "fuzz_command.ktx2", "--depth", "half", "--repair", "--clamp", "--drop-channels"},
      {"mipmap", image, "fuzz_command.dds", "--depth", "bc6h", "--repair", "--clamp", "--drop-channels"},
      {"prefilter", image, "fuzz_command.exr", "--size", "2", "--method", "treecode", "--repair", "--drop-channels",
       "--clamp"},
      {"sh", image, "--irradiance", "--json", "--repair", "--drop-channels"},
      {"compare", image, image, "--json", "--difference", "fuzz_command.exr"},
  };
  return all;
}

const std::vector<Words> commands_of_scenes{
    {"render", "", "fuzz_command.exr", "--at", "0.1,0.2,0.3", "--size", "3", "--samples", "1", "--method", "raycast",
     "--to", "cube"},
    {"render", "", "fuzz_command.exr", "--at", "0.1,0.2,0.3", "--size", "3", "--samples", "1", "--method", "raycast",
     "--time", "0.5"},
};

void run(Words words) {
  words.insert(words.end(), {"--quiet", "--max-pixels", "100000"});
  tools::settings() = {};
  tools::Parsed parsed;
  try {
    tools::parse(words, parsed);
  } catch (const Error&) {
    std::abort();  // The words are ours.
  }
  try {
    (void)tools::run(parsed);
  } catch (const Error&) {
  }
}

}  // namespace

void fuzz_command(Bytes data) {
  if (data.empty()) return;
  const std::vector<Words>& of_images = commands_of_images();
  const std::size_t choice = std::to_integer<std::size_t>(data.back()) % (of_images.size() + commands_of_scenes.size());
  if (choice < of_images.size()) {
    std::ofstream(image, std::ios::binary)
        .write(reinterpret_cast<const char*>(data.data()), std::streamsize(data.size()));
    return run(of_images[choice]);
  }
  Words words = commands_of_scenes[choice - of_images.size()];
  words[1] = write_scene(data);
  run(words);
}

void fuzz_manifest(Bytes data) {
  // No patterns over all that the machine holds.
  std::string text(reinterpret_cast<const char*>(data.data()), data.size());
  std::ranges::replace(text, '/', '-');
  const std::string path = "fuzz_manifest.txt";
  std::ofstream(path, std::ios::binary) << text;
  try {
    for (const tools::Job& job : tools::read_manifest(path))
      if (job.words.empty() || job.outputs.empty()) std::abort();
  } catch (const Error&) {
  }
}
