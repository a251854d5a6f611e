#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <string>

#include "envmap/base/error.h"
#include "envmap/io/images/detect_layout.h"
#include "targets.h"

using namespace envmap;

void fuzz_words(Bytes data) {
  std::int32_t shape[2] = {1, 1};
  if (data.size() >= sizeof shape) std::memcpy(shape, data.data(), sizeof shape), data = data.subspan(sizeof shape);
  for (std::int32_t& length : shape) length = std::max(1, length & 0x7fffffff);
  const std::string text(reinterpret_cast<const char*>(data.data()), data.size());

  ImageFacts words, named, again, only_words;
  words.attributes[description] = text;
  for (const char* key : {"envmap:projection", "envmap:layout", "envmap:forward", "textureformat"})
    named.attributes[key] = text;
  const Metadata said = metadata(named), recorded = metadata(words);

  // What was understood is written so that it is understood again.
  again.attributes = attributes(recorded);
  only_words.attributes[description] = again.attributes[description];
  for (const ImageFacts* image : {&again, &only_words}) {
    const Metadata m = metadata(*image);
    if (m.projection != recorded.projection || m.layout != recorded.layout || m.forward != recorded.forward)
      std::abort();
  }
  try {
    // Texels of all faces fit in the image.
    const DetectedLayout r = detect_layout(shape[0], shape[1], said, recorded);
    const double texels = double(faces(r.projection)) * r.size * r.size * aspect(r.projection);
    if (r.size < 1 || texels > double(shape[0]) * shape[1]) std::abort();
  } catch (const InputError&) {
  } catch (const UsageError&) {
  }
}
