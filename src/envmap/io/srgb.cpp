#include "envmap/io/srgb.h"

#include <OpenColorIO/OpenColorIO.h>

namespace envmap {
namespace {

namespace ocio = OCIO_NAMESPACE;

ocio::ConstCPUProcessorRcPtr make_processor(ocio::TransformDirection direction) {
  const auto curve = ocio::ExponentWithLinearTransform::Create();
  curve->setGamma({2.4, 2.4, 2.4, 1.0});
  curve->setOffset({0.055, 0.055, 0.055, 0.0});
  curve->setDirection(direction);
  // Lossless: the default trades the power function for an approximation.
  return ocio::Config::CreateRaw()->getProcessor(curve)->getOptimizedCPUProcessor(ocio::OPTIMIZATION_LOSSLESS);
}

void apply(const ocio::ConstCPUProcessorRcPtr& processor, std::span<Colour> pixels) {
  if (pixels.empty()) return;
  ocio::PackedImageDesc image(pixels.data(), static_cast<long>(pixels.size()), 1, 3);
  processor->apply(image);
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
