#include "envmap/io/bands.h"
#include "envmap/io/containers.h"
#include "envmap/io/dds_header.h"
#include "envmap/io/write_plan.h"

namespace envmap {

void write_dds(OutputFile& file, std::span<const Atlas> levels, const TexturePlan& plan, const Progress& progress) {
  using namespace dds;
  const TexelFormat& format = format_of(plan.texels);
  const bool chain = levels.size() > 1, cube = plan.cube;
  Header h{};
  h.magic = four("DDS ");
  h.size = sizeof(Header) - 4;
  h.flags = flags_of_texture | (format.side > 1 ? flag_size : flag_pitch) | (chain ? flag_levels : 0);
  h.width = std::uint32_t(levels[0].width());
  h.height = cube ? h.width : std::uint32_t(levels[0].height());
  // Of blocks the size of the first image, else that of a row.
  h.pitch = std::uint32_t(format.side > 1 ? format.image_bytes(levels[0].width(), int(h.height))
                                          : format.row_bytes(levels[0].width()));
  h.levels = std::uint32_t(levels.size());
  h.format = {.size = sizeof(Header::PixelFormat), .flags = format_four_cc, .four_cc = four("DX10")};
  h.caps = caps_texture | (chain || cube ? caps_complex : 0) | (chain ? caps_levels : 0);
  h.caps2 = cube ? caps2_cube | caps2_all_faces : 0;
  const Dx10 dx10{format.dxgi, dimension_2d, cube ? misc_cube : 0, 1, alpha_opaque};
  file.put(&h, sizeof h);
  file.put(&dx10, sizeof dx10);

  std::vector<Atlas> images;
  for (std::size_t face = 0; face < (cube ? 6 : 1); ++face)
    for (const Atlas& level : levels) images.push_back(images_of(level, cube)[face]);
  Shares shares(progress, levels);
  encode_images(format, images, shares, [&](std::span<const std::byte> rows) { file.put(rows.data(), rows.size()); });
}

}  // namespace envmap
