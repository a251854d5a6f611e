#include "envmap/io/claims/srgb.h"

#include "envmap/io/claims/colour_config.h"

namespace envmap {
namespace {

ocio::ConstCPUProcessorRcPtr make_processor(ocio::TransformDirection direction) {
  const auto curve = srgb_curve();
  curve->setDirection(direction);
  return on_cpu(ocio::Config::CreateRaw()->getProcessor(curve));
}

}  // namespace

void decode_srgb(std::span<Colour> pixels) {
  static const ocio::ConstCPUProcessorRcPtr processor = make_processor(ocio::TRANSFORM_DIR_FORWARD);
  apply(processor, pixels);
}

void encode_srgb(std::span<Colour> pixels) {
  static const ocio::ConstCPUProcessorRcPtr processor = make_processor(ocio::TRANSFORM_DIR_INVERSE);
  apply(processor, pixels);
}

}  // namespace envmap
