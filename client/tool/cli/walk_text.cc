#include "client/tool/cli/walk_text.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <iterator>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_join.h"

namespace latvox::client {
namespace {

// Returns the text of the numbers, with digits that give them back: StrJoin has six, too few for large coordinates.
std::string Digits(const Vec3d& point) {
  return absl::StrJoin(point, ",", [](std::string* out, double number) {
    char digits[32];
    out->append(digits, std::to_chars(digits, std::end(digits), number).ptr);
  });
}

// A closed mesh may have openings, too: a bottle's.
std::string LeakText(const Leak& leak, bool closed, double voxel_size) {
  const std::string from = absl::StrJoin(leak.from, ",");
  if (leak.kind == Leak::Kind::kFound && leak.steps == 0) {
    return absl::StrCat("no leak: lattice point ", from, " lies outside of the mesh's box\n");
  }
  switch (leak.kind) {
    case Leak::Kind::kNone:
      return absl::StrCat("no leak: lattice point ", from, " is enclosed\n");
    case Leak::Kind::kInSurface:
      return absl::StrCat("no leak: lattice point ", from, " lies in the surface, or with --close too near to it\n");
    case Leak::Kind::kBoxTooLarge:
      return absl::StrCat("leak: the walk from lattice point ", from, " gets outside; a way is not searched among ",
                          leak.box_points, " points, ask at a lower resolution\n");
    case Leak::Kind::kFound:
      break;
  }
  return absl::StrFormat(
      "leak: the walk from lattice point %s gets outside in %d steps, through an opening around %s\n"
      "      its middle is %.4g from the mesh; --close %.3g may close it\n%s",
      from, leak.steps, Digits(leak.narrowest_world), leak.room, 2 * leak.room + voxel_size,
      closed ? "      the mesh is closed, so the point lies outside of it, perhaps in a hollow of its surface\n" : "");
}

}  // namespace

std::string WalkText(const VoxelizeReport& report) {
  const auto& walk = report.summary.certificate.walk;
  const double voxel_size = report.accepted.grid.voxel_size, cell = std::pow(voxel_size, 3);
  if (!walk) return "";
  std::string text = absl::StrCat(walk->cavities, walk->cavities == 1 ? " enclosed part" : " enclosed parts");
  if (!walk->largest_cavities.empty()) {
    const uint64_t points = walk->largest_cavities[0];
    absl::StrAppendFormat(&text, ", the largest of %d points, volume %.6g", points, static_cast<double>(points) * cell);
  }
  text += "\n";
  if (walk->leak) text += LeakText(*walk->leak, report.summary.certificate.closed, voxel_size);
  for (const LabelWalk& of_label : walk->labels) {
    if (!of_label.leak) continue;
    absl::StrAppend(&text, "label ", of_label.label, ": ", LeakText(*of_label.leak, false, voxel_size));
  }
  const auto has_leak = [](const LabelWalk& of_label) { return of_label.leak.has_value(); };
  if (report.leak_from && !walk->leak && std::none_of(walk->labels.begin(), walk->labels.end(), has_leak)) {
    absl::StrAppend(&text, "no leak: ", Digits(*report.leak_from), " lies in no label's box\n");
  }
  return text;
}

}  // namespace latvox::client
