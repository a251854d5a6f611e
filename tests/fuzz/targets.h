/// @file
/// What libFuzzer runs (fuzz.cpp) and what the tests run over the corpus of the repository (corpus_test.cpp): any bytes
/// are what the target reads, or an InputError or UsageError comes out inside, in one line.
/// Anything else ends the process.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdlib>
#include <span>
#include <string_view>

using Bytes = std::span<const std::byte>;

/// Behind the mark of one format, in memory: hdr, exr, ktx2, ktx, dds, env, glb (its light), png, jpg, tif, pfm.
void fuzz_image(std::string_view format, Bytes bytes);
/// Blocks of BC6H as they are, and what the encoder makes of their texels.
void fuzz_bc6h(Bytes bytes);
/// An ICC profile.
void fuzz_icc(Bytes bytes);
/// The metadata of a gain map: XMP, or the numbers of ISO 21496-1.
void fuzz_gain(Bytes bytes);
/// An OpenColorIO config; without a line break, the name of a built-in space.
void fuzz_colours(Bytes bytes);
/// The text or document of a scene, in memory: obj, mtl, gltf (GLB by its mark).
void fuzz_text(std::string_view format, Bytes bytes);
/// An image of any format as a file or from standard input. The last byte chooses the options; every format can do
/// without it, so seeds and finds are plain image files.
void fuzz_read(Bytes bytes);
/// A scene of any format as a file: write_scene() in sound_scene.h.
void fuzz_scene(Bytes bytes);
/// Parts of a map, EXR files one after the other.
void fuzz_part(Bytes bytes);
/// A manifest of `batch`; no command is run.
void fuzz_manifest(Bytes bytes);
/// A file as a command of the program takes it, from its options to the file it writes.
/// The last byte chooses the command.
void fuzz_command(Bytes bytes);
/// Calls of the library's public functions with any values.
void fuzz_library(Bytes bytes);
/// An image description, attribute values and a shape: what the metadata says and what is recognised in it.
void fuzz_words(Bytes bytes);

inline void fuzz(std::string_view target, Bytes bytes) {
  if (target == "read") return fuzz_read(bytes);
  if (target == "scene") return fuzz_scene(bytes);
  if (target == "words") return fuzz_words(bytes);
  if (target == "bc6h") return fuzz_bc6h(bytes);
  if (target == "icc") return fuzz_icc(bytes);
  if (target == "gain") return fuzz_gain(bytes);
  if (target == "colours") return fuzz_colours(bytes);
  if (target == "part") return fuzz_part(bytes);
  if (target == "manifest") return fuzz_manifest(bytes);
  if (target == "command") return fuzz_command(bytes);
  if (target == "library") return fuzz_library(bytes);
  if (target == "obj" || target == "mtl" || target == "gltf") return fuzz_text(target, bytes);
  fuzz_image(target, bytes);
}

/// Ends the process where a message is more than one line, or could speak to a terminal.
inline void expect_harmless(std::string_view message) {
  if (std::ranges::any_of(message, [](unsigned char c) { return c < ' ' || c == 0x7f; })) std::abort();
}
