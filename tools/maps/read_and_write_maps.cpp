#include "maps/read_and_write_maps.h"

#include <fmt/format.h>
#include <sys/stat.h>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <set>

#include "cli/console.h"
#include "envmap/base/error.h"
#include "envmap/io/files/face_names.h"
#include "envmap/io/files/output_file.h"
#include "envmap/io/read_photo.h"
#include "envmap/io/write_distances.h"
#include "envmap/io/write_plan.h"
#include "envmap/operate/brightest.h"

namespace tools {
namespace {

using namespace envmap;
namespace fs = std::filesystem;

struct Depfile {
  std::vector<std::string> outputs, inputs;
  FaceNames faces;
  std::unique_ptr<OutputFile> file;
  bool opened = false;
};
Depfile& depfile() {
  static Depfile one;
  return one;
}

// As GCC writes names (mkdeps): a backslash before spaces and #, those before it doubled; $ doubled; other backslashes
// as they are. Beyond GCC, which leaves them, colons get a backslash, too: make and ninja read both.
std::string escaped(const std::string& name) {
  std::string out;
  std::size_t backslashes = 0;
  for (const char c : name) {
    if (c == '\n') throw UsageError(name, "a depfile cannot hold a name of two lines");
    if (c == ' ' || c == '\t' || c == '#') out += std::string(backslashes + 1, '\\');
    if (c == ':') out += '\\';
    if (c == '$') out += '$';
    out += c;
    backslashes = c == '\\' ? backslashes + 1 : 0;
  }
  return out;
}

// Each once, in the order in which they come.
std::vector<std::string> inputs_of(const std::vector<std::string>& paths, const std::string& faces) {
  std::vector<std::string> all;
  for (const std::string& path : paths)
    for (const std::string& file : files_of(path, std::max(1, count_level_files(path, face_files(faces))), faces))
      if (std::ranges::find(all, file) == all.end()) all.push_back(file);
  return all;
}

// The same for all names of a file; empty for devices and pipes, which may well be read and written.
std::string identity(const std::string& path) {
  struct stat status = {};
  if (::stat(path.c_str(), &status) == 0)
    return S_ISREG(status.st_mode) ? fmt::format("{} {}", status.st_dev, status.st_ino) : "";
  std::error_code error;
  return fs::weakly_canonical(fs::absolute(path, error), error).string();
}

}  // namespace

bool is_prefiltered_chain(const Source& source) { return source.levels > 1 && source.facts.contains("lobe"); }

std::vector<std::string> files_of(const std::string& path, int levels, const std::string& faces) {
  if (path.empty() || path == "-") return {};
  return files_named(path, levels, face_files(faces));
}

void check_files(const std::vector<std::string>& outputs, const std::vector<std::string>& inputs,
                 const FaceNames& faces, const std::vector<std::string>& others) {
  depfile() = {outputs, inputs, faces, nullptr, false};
  if (settings().json && (std::ranges::find(outputs, "-") != outputs.end() || settings().depfile == "-"))
    throw UsageError("--json and the output cannot both be standard output: give a file name");
  if (std::ranges::count(inputs, "-") > 1) throw UsageError("-: standard input can be read once, and is named twice");
  std::set<std::string> written, read;
  for (const std::string& input : inputs_of(inputs, faces.read)) read.insert(identity(input));
  read.erase("");
  std::vector<std::string> files{settings().depfile};
  files.insert(files.end(), outputs.begin(), outputs.end());
  files.insert(files.end(), others.begin(), others.end());
  // How many levels will be written is not known yet: no name that one could have is free.
  for (const std::string& output : files) {
    for (const std::string& file : files_of(output, int(limits::levels.most), faces.written)) {
      const std::string id = identity(file);
      if (read.contains(id)) throw UsageError(file, "is both input and output: choose another output name");
      if (!id.empty() && !written.insert(id).second)
        throw UsageError(file, "would be written twice: give each output a name of its own");
    }
    // Else only what differs is replaced.
    if (!settings().commit.if_changed)
      for (const std::string& file : files_of(output, 1, faces.written)) check_replaceable(file, settings().commit);
  }
}

void open_depfile(int levels) {
  if (settings().depfile.empty() || depfile().opened) return;
  depfile().opened = true;
  std::string text, phony;
  for (const std::string& output : depfile().outputs)
    for (const std::string& file : files_of(output, levels, depfile().faces.written))
      text += (text.empty() ? "" : " ") + escaped(file);
  if (text.empty()) throw UsageError("--depfile: no file is written that could depend on another");
  text += ":";
  std::vector<std::string> all = depfile().inputs;
  all.insert(all.end(), settings().also_read.begin(), settings().also_read.end());
  for (const std::string& input : inputs_of(all, depfile().faces.read)) {
    text += " " + escaped(input);
    phony += escaped(input) + ":\n";
  }
  text += "\n" + phony;
  depfile().file = std::make_unique<OutputFile>(settings().depfile, settings().commit);
  depfile().file->write(text.data(), text.size());
  depfile().file->check();
  if (!depfile().file->is_stream()) return;
  // Devices and pipes have their bytes before the outputs.
  depfile().file->commit();
  depfile().file.reset();
}

void commit_depfile() {
  if (depfile().file) depfile().file->commit();
}

PendingDepfile::~PendingDepfile() { depfile() = {}; }

namespace {

// @param reader read() or read_photo().
Source told(Source (*reader)(const std::string&, const ReadOptions&, const Run&), const std::string& path,
            const ReadOptions& options) {
  const Stopwatch watch;
  Source source = reader(path, options, {});
  if (source.repaired > 0) warn(fmt::format("{}: repaired {} texels", path, source.repaired));
  for (const auto* files : {&source.colour_files, &source.files})
    settings().also_read.insert(settings().also_read.end(), files->begin(), files->end());
  for (const std::string& what : source.notes) warn(fmt::format("{}: {}", path, what));
  if (settings().verbose) {
    for (const std::string& what : source.details) detail(fmt::format("{}: {}", path, what));
    const Level& level = source.map.base();
    detail(fmt::format("{}: {} {}x{}{}, {} {}, read in {:.2f} s", path, name(level.projection()), level.width(),
                       level.height(), level.faces() > 1 ? fmt::format(" x {} faces", level.faces()) : "",
                       source.format, name(source.depth), watch.seconds()));
  }
  return source;
}

}  // namespace

Source read_map(const std::string& path, const ReadOptions& options) { return told(read, path, options); }
Source read_picture(const std::string& path, const ReadOptions& options) { return told(read_photo, path, options); }

std::string equal_brightest(std::string_view command, const std::string& path, const EnvironmentMap& map) {
  constexpr double bright = 4;  // Times the mean: plain maps are no lights.
  const Level& level = map.base();
  double most = 0, sum = 0;
  std::int64_t count = 0, all = 0;
  for (int face = 0; face < level.faces(); ++face)
    for (int j = 0; j < level.height(); ++j) {
      const Columns in = level.weighted_columns(j);
      for (int i = in.first; i < in.end; ++i) {
        const double y = luminance_of(*level.texel(face, i, j));
        if (y > most) most = y, count = 0;
        count += y == most;
        sum += y, ++all;
      }
      level.trim();
    }
  if (count < 2 || most * double(all) <= bright * sum) return {};
  return fmt::format(
      "envmap {}: {}: {} texels hold the largest value, {:g}: if its light was clipped, the result is too dark",
      command, path, count, most);
}

void tell_clamping(const std::string& path, const Written& written) {
  if (written.clamped > 0)
    warn(
        fmt::format("{}: clamped {} texels, {:.3g}% of the flux lost", path, written.clamped, 100 * written.flux_lost));
}

Written write_map(const std::string& path, const Rows& rows, const WriteOptions& options, const std::string& verb) {
  return write_map(path, std::span(&rows, 1), options, verb);
}

Written write_map(const std::string& path, std::span<const Rows> levels, const WriteOptions& options,
                  const std::string& verb) {
  const Stopwatch watch;
  const std::vector<std::string> colours = out_of_working(options.colour).files;
  settings().also_read.insert(settings().also_read.end(), colours.begin(), colours.end());
  open_depfile(int(levels.size()));
  const Rows& rows = levels.front();
  WriteOptions how = options;
  how.commit = settings().commit;
  const Written written = write(path, levels, how, {.progress = progress_line(verb)});
  tell_clamping(path, written);
  if (settings().verbose)
    detail(fmt::format("{}: {} {}x{}{}{}, {}, {}written in {:.2f} s", path, name(rows.projection), rows.width(),
                       rows.size,
                       rows.projection == Projection::cube ? fmt::format(" x 6 faces ({})", name(written.layout)) : "",
                       levels.size() > 1 ? fmt::format(", {} levels", levels.size()) : "", name(written.depth),
                       verb == "write" ? "" : "made and ", watch.seconds()));
  return written;
}

void write_distances(const std::string& path, const EnvironmentMap& map, std::span<const float> distances,
                     const Direction& at, const WriteOptions& options) {
  WriteOptions how = options;
  how.commit = settings().commit;
  how.facts["at"] = fmt::format("{:.7g},{:.7g},{:.7g}", at.x, at.y, at.z);
  tell_clamping(path, write_with_distances(path, map, distances, how));
}

void tell_lost_facts(const std::string& path, const Frame& frame, const WriteOptions& options) {
  const std::string type = extension(path, options);
  const FileFormat* const format = format_with_extension(type);
  if (!format || format->frame) return;
  if (const auto& white = options.provenance.white_luminance)
    note(fmt::format("{}: .{} files do not store the unit: radiance 1 is {:.6g} cd/m^2", path, type, *white));
  if (frame.forward == Forward::plus_z) return;
  note(fmt::format("{}: .{} files do not store the axis at the centre: read it with --from-forward {}", path, type,
                   forward_names[std::size_t(frame.forward)]));
}

void write_text(const std::string& path, std::string_view text) {
  OutputFile file(path, settings().commit);
  file.write(text.data(), text.size());
  file.commit();
}

}  // namespace tools
