#include "envmap/io/read.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <limits>
#include <numeric>
#include <vector>

#include "envmap/base/error.h"
#include "envmap/base/parallel.h"
#include "envmap/base/run_operation.h"
#include "envmap/io/claims/claimed_space.h"
#include "envmap/io/claims/gpano.h"
#include "envmap/io/files/face_names.h"
#include "envmap/io/images/detect_layout.h"
#include "envmap/io/images/exif_orientation.h"
#include "envmap/io/images/open_image.h"
#include "envmap/io/images/read_pixels.h"
#include "envmap/io/metadata.h"
#include "envmap/io/read_photo.h"
#include "envmap/map/mirrored_rows.h"
#include "envmap/map/octahedral_border.h"
#include "envmap/operate/border_samples.h"
#include "envmap/operate/convert.h"
#include "envmap/operate/edges_meet.h"
#include "envmap/operate/measure.h"
#include "envmap/operate/refuse_flaws.h"

namespace envmap {
namespace {

void check_pixels(const Image& image, const ReadOptions& options, int width, int height, int faces) {
  const auto pixels = std::uint64_t(width) * std::uint64_t(height) * std::uint64_t(faces);
  if (pixels > options.max_pixels)
    image.fail(fmt::format("{}x{}{} is over {} pixels", width, height,
                           faces > 1 ? fmt::format(" x {} faces", faces) : "", options.max_pixels),
               Remedy::allow_pixels);
}

void check_size(const Image& image, const ReadOptions& options) {
  const ImageFacts& facts = image.reader->facts;
  if (!facts.flat) image.fail("holds deep samples or a volume, not a flat image");
  if (facts.width < 1 || facts.height < 1) image.fail("not a flat image");
  check_pixels(image, options, facts.width, facts.height, 1);
  const double bytes = double(facts.width) * facts.height * sizeof(Colour);
  const double memory = double(::sysconf(_SC_PHYS_PAGES)) * double(::sysconf(_SC_PAGE_SIZE));
  // A header can promise anything. No compression in use makes a map 20,000 times smaller, but for some of OpenEXR:
  // check_openexr().
  if (image.size > 0 && bytes > 0x1p28 && bytes > 2e4 * double(image.size) && image.reader->format != "openexr")
    image.fail(fmt::format("truncated or damaged: {} bytes cannot hold {}x{}", image.size, facts.width, facts.height));
  if (bytes > memory && options.max_memory == 0)
    image.fail(fmt::format("{}x{} needs {:.0f} GiB of memory; this machine has {:.0f}", facts.width, facts.height,
                           bytes / 0x1p30, memory / 0x1p30),
               Remedy::limit_memory);
}

// The numbers of the levels to read, of those there are.
std::vector<int> wanted_levels(const std::string& name, const ReadOptions& options, int levels) {
  if (options.level >= levels)
    throw InputError(name, levels == 1
                               ? fmt::format("has no level {}: there is but one, 0", options.level)
                               : fmt::format("has no level {}: its levels are 0 to {}", options.level, levels - 1));
  std::vector<int> wanted{options.level};
  for (int k = 1; options.all_levels && k < levels; ++k) wanted.push_back(k);
  return wanted;
}

DetectedLayout detect_layout(const Image& image, const ReadOptions& options, const Metadata& recorded, int width,
                             int height) {
  try {
    if (!image.texture || !image.texture->cube)
      return detect_layout(width, height, {options.projection, options.layout}, recorded);
  } catch (const InputError& e) {
    image.fail(e.what(), e.remedy());
  }
  if (options.projection && *options.projection != Projection::cube)
    image.fail(fmt::format("holds a cube map, not a {} map", name(*options.projection)));
  if (options.layout)
    throw UsageError(image.name, "holds cube faces as the APIs define them", Remedy::leave_out_from_layout);
  return {Projection::cube, Layout::api, height};
}

// The level with the radiance from d coming from rotation x d.
Level turned(Level level, Forward forward, const Rotation& rotation) {
  const ConvertOptions options{.to = Frame{level.projection(), forward}, .size = level.height(), .rotation = rotation};
  EnvironmentMap map{.levels = {}, .forward = forward};
  map.levels.push_back(std::move(level));
  return std::move(convert(map, options).levels.front());
}

void multiply(Level& level, double gain) {
  for_each_row(level.faces(), level.height(), {}, [&](int face, int row) {
    for (Colour& c : level.row(face, row)) c = Colour(Flux(c) * gain);
  });
}

// The faces of one image, where it does not hold them in the usual order, or not upright.
Level with_faces(const Level& stored, Layout layout, const std::string& faces) {
  const Grid places = grid(layout);
  std::array<int, 6> usual;  // The face that each place has, in the order of places.
  std::iota(usual.begin(), usual.end(), 0);
  std::ranges::sort(usual, {}, [&](int face) {
    const Slot& slot = places.slots[std::size_t(face)];
    return std::pair(slot.row, slot.column);
  });
  const std::array<FaceCell, 6> cells = face_cells(faces);
  Level level(stored.projection(), stored.height(), stored.width(), stored.max_memory());
  for (std::size_t k = 0; k < cells.size(); ++k)
    copy_upright(stored, usual[k], cells[k].stored, level, int(cells[k].face));
  return level;
}

// A level, `stored` by that number in the file.
Level read_stored(Image& image, const ReadOptions& options, int stored, const DetectedLayout& base, int number,
                  const Progress& progress) {
  if (!image.texture) return read_pixels(image, options, stored, base, face_in(image, stored, base, number), progress);
  const TextureFile& texture = *image.texture;
  try {
    Level level = read_texture(*image.file, texture, stored, base, number, options.drop_channels,
                               texture.by_integers && image.decode);
    if (texture.rotation != Rotation(1)) level = turned(std::move(level), Forward::plus_z, texture.rotation);
    if (texture.gain != 1) multiply(level, texture.gain);
    return level;
  } catch (const InputError& e) {
    image.fail(e.what(), e.remedy());
  }
}

// The same with its faces where the options say.
Level read_level(Image& image, const ReadOptions& options, int stored, const DetectedLayout& base, int number,
                 const Progress& progress) {
  Level level = read_stored(image, options, stored, base, number, progress);
  const bool named = !options.faces.empty() && base.projection == Projection::cube;
  return named ? with_faces(level, base.layout, options.faces) : std::move(level);
}

// What a file says of itself, without its levels.
Source read_head(const Image& image, const ReadOptions& options, Metadata& recorded) {
  if (image.texture) {
    const TextureFile& t = *image.texture;
    check_pixels(image, options, t.width, t.height, t.cube ? 6 : 1);
    recorded = t.recorded;
    return {.depth = t.format().depth,
            .format = t.container,
            .image_width = t.width,
            .image_height = t.height,
            .border_samples = options.border_samples,
            .levels = t.levels,
            .files = t.files,
            .notes = t.notes,
            .details = t.details,
            .claims = t.claims};
  }
  const ImageFacts& facts = image.reader->facts;
  check_size(image, options);
  recorded = metadata(facts);
  return {.depth = facts.depth,
          .format = image.reader->format,
          .image_width = facts.width,
          .image_height = facts.height,
          .border_samples =
              options.border_samples || (has_border_samples(facts.attributes) && !options.ignore_envmap_attribute),
          .levels = recorded.levels.value_or(std::numeric_limits<int>::max()),
          .notes = facts.notes,
          .details = facts.details,
          .claims = facts.claims};
}

// Levels that a file has, at most.
int count_levels(const Image& image, int most) {
  int levels = 1;
  while (levels < most && image.reader->level_facts(levels)) ++levels;
  return levels;
}

// Of an octahedral map; 0 of others. Levels that it would fill are no part of the map.
int border_of(const Image& image, const ReadOptions& options, const Metadata& recorded, const DetectedLayout& found) {
  if (!is_octahedral(found.projection)) {
    if (options.border.value_or(0) > 0)
      image.fail(
          fmt::format("a border is that of octahedral and equal-area maps, not of a {} map", name(found.projection)));
    return 0;
  }
  const int border = options.border.value_or(recorded.border.value_or(0));
  if (found.size <= 2 * border)
    image.fail(fmt::format("a border of {} leaves nothing of {}x{}", border, found.size, found.size));
  return border;
}

// @param base of the map. @param claimed by the file of level 0.
void check_level_file(Image& image, const ReadOptions& options, const DetectedLayout& base, int number,
                      const ClaimedSpace& claimed) {
  Metadata recorded;
  const Source head = read_head(image, options, recorded);
  if (const ClaimedSpace c = claimed_space(image, recorded, options.colour); !same(c, claimed))
    image.fail(fmt::format("its colours are {}, but those of level 0 are {}", words(c), words(claimed)));
  if (!image.reader) return;
  const FaceSize face = face_in(image, 0, base, number);
  const Grid places = grid(base.layout);
  if (const int w = places.columns * face.width, h = places.rows * face.height;
      head.image_width != w || head.image_height != h)
    image.fail(fmt::format("{}x{}, but level {} is {}x{}", head.image_width, head.image_height, number, w, h));
}

void tell_pose(const Panorama& p, const ReadOptions& options, ImageFacts& facts) {
  const std::string pose = fmt::format("heading {:g}, pitch {:g}, roll {:g} degrees", p.heading.value_or(0),
                                       p.pitch.value_or(0), p.roll.value_or(0));
  if (!p.heading && !p.pitch && !p.roll) return;
  facts.claims.push_back({.name = "GPano pose",
                          .value = pose,
                          .outcome = options.apply_pose ? Claim::Outcome::honoured : Claim::Outcome::ignored,
                          .reason = options.apply_pose ? "" : "pictures are often made upright before it is written"});
  if (!options.apply_pose && (p.pitch.value_or(0) != 0 || p.roll.value_or(0) != 0))
    facts.notes.push_back("its camera was not held upright: " + pose + " (GPano), which are not applied");
}

// What cameras write of a panorama. An image that shows a part of it becomes all of it, black where nothing is.
std::optional<Panorama> place_panorama(Image& image, const ReadOptions& options) {
  const std::optional<Panorama> found = panorama_of(image);
  if (!found) return found;
  ImageFacts& facts = image.reader->facts;
  const bool overridden = options.projection.value_or(Projection::latlong) != Projection::latlong;
  Claim claim{.name = "GPano", .value = found->projection};
  if (overridden) claim.outcome = Claim::Outcome::overridden;
  const auto window = overridden ? std::nullopt : window_in(*found, facts.width, facts.height);
  if (window)
    claim.value = fmt::format("{}x{} of a panorama of {}x{}, at {},{}", facts.width, facts.height, window->width,
                              window->height, window->x, window->y);
  facts.claims.push_back(claim);
  if (window) facts.notes.push_back(fmt::format("shows {} (GPano): what is missing is black", claim.value));
  if (!overridden) tell_pose(*found, options, facts);
  if (window) image.reader = in_window(std::move(*image.reader), *window);
  return overridden ? std::nullopt : found;
}

// A photo may have the shape of a map.
void tell_of_edges(const Image& image, const DetectedLayout& found, const ReadOptions& options,
                   const Metadata& recorded, Source& source) {
  const bool by_its_shape = !options.projection && !options.layout && !recorded.projection && !image.texture;
  if (!by_its_shape || edges_meet(source.map.base())) return;
  const bool cube = found.projection == Projection::cube;
  source.notes.push_back(fmt::format(
      "its shape is that of a {} map, but {} do not meet: is it a photo of a ball (sphere, with its circle){}?",
      cube ? fmt::format("cube ({})", name(found.layout)) : std::string(name(found.projection)),
      cube ? "its faces" : "its sides", cube ? ", or are its faces in another order" : " or of a part of the sphere"));
}

// Turns a map back that was mirrored for an engine.
void turn_back(const Image& image, Source& source) {
  const auto said = source.facts.find(std::string(mirrored_fact));
  if (said == source.facts.end()) return;
  const std::string axis = said->second;
  if ((axis != "x" && axis != "z") || (axis == "z" && source.map.projection() != Projection::cube))
    image.fail(fmt::format("is mirrored along '{}': not known", axis));
  const MirroredAxis mirror = axis == "x" ? MirroredAxis::x : MirroredAxis::z;
  for (Level& level : source.map.levels) level = level_of(mirrored_rows(rows_of(level, source.map.forward), mirror));
  source.facts.erase(said);
  source.claims.push_back({.name = "mirrored", .value = axis});
}

// @param image open. @param path its name, which may have {level} in it; empty in memory.
Source read_image(Image& image, const std::string& path, const ReadOptions& options, const Progress& progress) {
  std::optional<Panorama> panorama;
  try {
    panorama = place_panorama(image, options);
  } catch (const InputError& e) {
    image.fail(e.what(), e.remedy());
  }
  Metadata recorded;
  Source source = read_head(image, options, recorded);
  const DetectedLayout found = detect_layout(image, options, recorded, source.image_width, source.image_height);
  if (!options.faces.empty() && (found.projection != Projection::cube || found.layout == Layout::api))
    throw UsageError(image.name, found.layout == Layout::api
                                     ? "its format says which face is which: no names are needed"
                                     : "is no cube map: names of faces are for those");
  source.layout = found.layout;
  source.facts = recorded.facts;
  source.provenance = recorded.provenance;
  record_colours(source, image, recorded, options.colour);
  source.border = border_of(image, options, recorded, found);
  const bool in_files = has_level(path);
  // A texture counts the levels that it holds itself.
  int most = in_files && image.texture ? complete_levels(found) : std::min(source.levels, complete_levels(found));
  while (source.border > 0 && face_size(found, most - 1).height <= 2 * source.border) --most;
  source.levels = in_files        ? std::min(most, count_level_files(path, {}))
                  : image.texture ? most
                                  : count_levels(image, most);
  for (const int k : wanted_levels(image.name, options, source.levels)) {
    const Progress of_level = k == options.level ? progress : Progress();  // The largest is most of the work.
    if (in_files && k > 0) {
      Image one;
      open(one, level_path(path, k), options.choice);
      check_level_file(one, options, found, k, source.claimed);
      one.decode = image.decode;
      source.map.levels.push_back(read_level(one, options, 0, found, k, of_level));
    } else {
      source.map.levels.push_back(read_level(image, options, k, found, k, of_level));
    }
  }
  if (source.border > 0)
    for (Level& level : source.map.levels) level = without_border(level, source.border);
  tell_of_edges(image, found, options, recorded, source);
  turn_back(image, source);
  if (has_forward(found.projection)) {
    const auto known = options.forward    ? options.forward
                       : recorded.forward ? recorded.forward
                                          : options.assumed_forward;
    source.map.forward = known.value_or(Forward::plus_z);
    source.forward_is_assumed = !known;
  }
  const bool has_pose = panorama && (panorama->heading || panorama->pitch || panorama->roll);
  if (options.apply_pose && !has_pose) source.notes.emplace_back("has no pose in GPano XMP: it is not rotated");
  if (options.apply_pose && has_pose) {
    const Rotation frame = image_to_world(source.map.forward);
    source.pose = frame * pose_of(*panorama) * glm::transpose(frame);
  }
  return source;
}

void open_face(Image& image, const std::string& path, const ReadOptions& options) {
  std::error_code error;
  if (!std::filesystem::exists(path, error)) throw InputError(path, "no such file", Remedy::choose_faces);
  open(image, path, options.choice);
}

// The convention that a face file says it was written in, or nothing.
std::string_view recorded_convention(const Metadata& recorded) {
  const auto said = recorded.facts.find(std::string(faces_fact));
  return said == recorded.facts.end() ? std::string_view() : convention_of(said->second);
}

std::string lies(std::string_view convention) {
  return convention.empty() ? "upright as seen from inside" : fmt::format("as {} has it", convention);
}

// One level out of a file for each face, of a map that is `size` high at its base; 0: what the first file says.
Level read_face_files(const std::string& path, const FaceFiles& files, const ReadOptions& options, int number, int size,
                      Source& source, const Progress& progress) {
  const Projection projection = projection_of_faces(path);
  std::optional<Level> level;
  std::string_view convention;  // The first file's.
  for (int face = 0; face < faces(projection); ++face) {
    Image image;
    open_face(image, face_path(level_path(path, number), face, files), options);
    Metadata recorded;
    const Source head = read_head(image, options, recorded);
    const int w = head.image_width, h = head.image_height;
    if (w != h) image.fail(fmt::format("a face must be square, not {}x{}", w, h));
    check_pixels(image, options, w, h, faces(projection));
    if (image.texture && image.texture->cube) image.fail("holds a whole cube map, not one face");
    if (size == 0) {
      size = h;
      source.depth = head.depth;
      source.format = head.format;
      source.provenance = recorded.provenance;
      source.image_width = source.image_height = size;
      source.claims = head.claims;
      record_colours(source, image, recorded, options.colour);
      source.facts = recorded.facts;
    }
    if (number == 0)
      for (const std::string& note : head.notes) source.notes.push_back(fmt::format("{}: {}", image.name, note));
    if (const ClaimedSpace c = claimed_space(image, recorded, options.colour); !same(c, source.claimed))
      image.fail(fmt::format("its colours are {}, but the first face is {}", words(c), words(source.claimed)));
    if (const auto unit = recorded.provenance.white_luminance; unit != source.provenance.white_luminance && number == 0)
      image.fail(fmt::format("its whiteLuminance is {}, but that of the first face {}", unit.value_or(1),
                             source.provenance.white_luminance.value_or(1)));
    if (face == 0) convention = recorded_convention(recorded);
    if (const std::string_view other = recorded_convention(recorded); options.faces.empty() && other != convention)
      image.fail(fmt::format("its picture lies {}, but that of the first face {}", lies(other), lies(convention)),
                 Remedy::choose_faces);
    const int wanted = std::max(1, size >> number);
    if (h != wanted)
      image.fail(number == 0 ? fmt::format("{}x{}, but the first face is {}x{}", w, h, wanted, wanted)
                             : fmt::format("{}x{}, but level {} of faces of {}x{} is {}x{}", w, h, number, size, size,
                                           wanted, wanted));
    if (!level) level.emplace(projection, wanted);
    // Any projection of one square face.
    const Level one = read_level(image, options, 0, {Projection::sphere, Layout::single, wanted}, 0, {});
    const bool cube = projection == Projection::cube;
    copy_upright(one, 0, cube ? files[std::size_t(face)].stored : Orientation::upright, *level, face);
    if (progress) progress((face + 1.0) / faces(projection));
  }
  return std::move(*level);
}

// As was said, or as the first of them says that it was written.
FaceFiles files_of(const std::string& path, const ReadOptions& options) {
  const FaceFiles files = face_files(options.faces);
  if (!options.faces.empty() || has_half(path)) return files;
  Image first;
  Metadata recorded;
  open_face(first, face_path(level_path(path, 0), 0, files), options);
  read_head(first, options, recorded);
  return face_files(recorded_convention(recorded));
}

Source read_faces(const std::string& path, const ReadOptions& options, const Progress& progress) {
  const Projection projection = projection_of_faces(path);
  if (options.projection && *options.projection != projection)
    throw UsageError(fmt::format("{} in a file name is for {} maps, not for a {} map",
                                 has_half(path) ? half_mark : face_mark, name(projection), name(*options.projection)));
  if (!options.faces.empty() && projection != Projection::cube)
    throw UsageError(path, "names of faces are for cubes: remove them");
  if (options.apply_pose) throw UsageError(path, "a pose is that of a panorama in one image");
  const FaceFiles files = files_of(path, options);
  Source source{.map = {}, .layout = Layout::files, .border_samples = options.border_samples};
  // Level 0 even where another is wanted: it tells how large that one must be.
  source.map.levels.push_back(read_face_files(path, files, options, 0, 0, source, progress));
  const int size = source.map.base().height();
  source.levels = has_level(path)
                      ? std::min(complete_levels({projection, Layout::files, size}), count_level_files(path, files))
                      : 1;
  for (const int k : wanted_levels(path, options, source.levels))
    if (k > 0) source.map.levels.push_back(read_face_files(path, files, options, k, size, source, {}));
  if (options.level > 0) source.map.levels.erase(source.map.levels.begin());
  return source;
}

void check(const ReadOptions& options) {
  check_range(limits::level, options.level);
  if (options.border) check_range(limits::border, *options.border);
  check_enumerator("flaws", options.flaws);
  if (options.projection) check_enumerator("projection", *options.projection);
  if (options.layout) check_enumerator("layout", *options.layout);
  for (const auto& forward : {options.forward, options.assumed_forward})
    if (forward) check_enumerator("forward", *forward);
  if (options.border_samples && options.ignore_envmap_attribute)
    throw UsageError("border_samples and ignore_envmap_attribute contradict each other");
  if (options.choice.headroom) check_range(limits::headroom, *options.choice.headroom);
  if (options.all_levels && options.level != 0) throw UsageError("level must be 0 where all levels are read");
}

// NaN, infinite and negative radiance: refuses, repairs or keeps it, as the options say. @throws InputError.
void resolve_flaws(const std::string& name, const ReadOptions& options, Source& source) {
  if (options.flaws == FlawPolicy::keep) return;
  for (std::size_t k = 0; k < source.map.levels.size(); ++k) {
    Level& level = source.map.levels[k];
    const Flaws flaws = find_flaws(level);
    if (flaws.count() == 0) continue;
    if (options.flaws == FlawPolicy::refuse)
      throw InputError(name, flaw_words(flaws, level, k > 0 ? fmt::format(" of level {}", k) : ""), Remedy::repair);
    try {
      source.repaired += repair(level);
    } catch (const InputError& e) {
      throw InputError(name, e.what());
    }
  }
}

// @param take makes the map out of a file, as it is there.
template <class F>
Source read_and_finish(const std::string& name, const ReadOptions& options, const Progress& progress, const F& take) {
  try {
    Source source = take(progress);
    // Flaws are those of the file's own values. Only linear ones can be averaged.
    const ColourTransform colours = colours_of(source, options.colour);
    if (colours.apply) resolve_flaws(name, options, source);
    into_working(source, colours, options.colour);
    const Projection p = source.map.projection();
    if (source.border_samples && p != Projection::latlong && p != Projection::cube)
      throw InputError(name,
                       fmt::format("samples on the image border are those of latlong maps and cubes, not of a {} map",
                                   envmap::name(p)));
    if (source.border_samples)
      for (Level& level : source.map.levels) level = to_cell_centres(level);
    resolve_flaws(name, options, source);
    if (source.pose)
      for (Level& level : source.map.levels) level = turned(std::move(level), source.map.forward, *source.pose);
    return source;
  } catch (const std::bad_alloc&) {
    throw InputError(name, "not enough memory to read it");
  } catch (const std::length_error&) {  // Out of OpenImageIO's BMP reader, for one.
    throw InputError(name, "damaged: its header promises more than any memory holds");
  }
}

template <class F>
Source read_named(const std::string& path, const ReadOptions& options, const Run& run, const F& take) {
  check(options);
  const std::string name = path == "-" ? "standard input" : path;
  return run_operation(run, [&](const Progress& progress) { return read_and_finish(name, options, progress, take); });
}

// An image as it is, in a level that stands for no sphere.
Source read_photo(Image& image, const ReadOptions& options, const Progress& progress) {
  if (image.texture) image.fail("is a texture, not a photo");
  Metadata recorded;
  Source source = read_head(image, options, recorded);
  source.provenance = recorded.provenance;
  record_colours(source, image, recorded, options.colour);
  source.border_samples = false, source.levels = 1;
  const FaceSize whole{source.image_width, source.image_height};
  source.map.levels.push_back(
      read_pixels(image, options, 0, {Projection::latlong, Layout::single, whole.height}, whole, progress));
  return source;
}

}  // namespace

Source read_photo(const std::string& path, const ReadOptions& options, const Run& run) {
  return read_named(path, options, run, [&](const Progress& progress) {
    Image image;
    open(image, path, options.choice);
    return read_photo(image, options, progress);
  });
}

Source read(const std::string& path, const ReadOptions& options, const Run& run) {
  return read_named(path, options, run, [&](const Progress& progress) {
    if (has_face(path)) return read_faces(path, options, progress);
    Image image;
    open(image, level_path(path, 0), options.choice);
    return read_image(image, path, options, progress);
  });
}

Source read(std::span<const std::byte> file, const ReadOptions& options, const Run& run) {
  return read_named("", options, run, [&](const Progress& progress) {
    Image image;
    open_bytes(image, "", {reinterpret_cast<const char*>(file.data()), file.size()}, false, options.choice);
    return read_image(image, "", options, progress);
  });
}

}  // namespace envmap
