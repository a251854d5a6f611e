#include "scenes/mirror_report.h"

#include <fmt/format.h>

#include "cli/console.h"

namespace tools {

using namespace envmap;

namespace {

std::string words(const MapUpdate& update, const Mirror& mirror, const std::string& node) {
  switch (update.outcome) {
    case MapUpdate::Outcome::unseen: return fmt::format("{}: not seen, not drawn", node);
    case MapUpdate::Outcome::unchanged:
      return fmt::format("{}: its surroundings did not change, not drawn again", node);
    case MapUpdate::Outcome::drawn: break;
  }
  return fmt::format("{}: {} of {}, {} of {} faces drawn in {:.1f} ms", node, name(mirror.to), update.size,
                     update.faces, faces(mirror.to), 1e3 * update.seconds);
}

}  // namespace

void tell(const MirrorUpdates& updates, const Scene& scene, const std::vector<Mirror>& mirrors) {
  if (!settings().verbose) return;
  for (const MapUpdate& update : updates.maps) {
    const Mirror& mirror = mirrors[std::size_t(update.mirror)];
    note(words(update, mirror, scene.nodes[std::size_t(mirror.node)].name));
  }
  if (!updates.settled) note(fmt::format("mirrors go on changing each other after {} rounds", max_rounds));
}

void MirrorTable::add(const MirrorUpdates& of_frame) {
  for (const MapUpdate& update : of_frame.maps) {
    Row& row = rows_[std::size_t(update.mirror)];
    row.drawn += update.outcome == MapUpdate::Outcome::drawn;
    row.unchanged += update.outcome == MapUpdate::Outcome::unchanged;
    row.unseen += update.outcome == MapUpdate::Outcome::unseen;
    row.faces += update.faces, row.seconds += update.seconds;
    if (update.size > 0) row.size = update.size;
  }
}

void MirrorTable::put(Report& report) const {
  for (std::size_t k = 0; k < rows_.size(); ++k) {
    report.append("mirrors[]");
    report.put("mirrors[].node", scene_.nodes[std::size_t(mirrors_[k].node)].name);
    report.put("mirrors[].map", name(mirrors_[k].to));
    report.put("mirrors[].size", rows_[k].size);
    report.put("mirrors[].drawn", rows_[k].drawn);
    report.put("mirrors[].faces", rows_[k].faces);
    report.put("mirrors[].unchanged", rows_[k].unchanged);
    report.put("mirrors[].unseen", rows_[k].unseen);
    report.put("mirrors[].seconds", rows_[k].seconds);
  }
}

}  // namespace tools
