#include "client/internal/result_warnings.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "client/internal/vec3.h"

namespace latvox::client {
namespace {

template <class Box>
std::string Corners(const Box& box) {
  return absl::StrCat(absl::StrJoin(box.min, ","), ",", absl::StrJoin(box.max, ","));
}

int32_t ToIndex(double x) {
  constexpr double kMost = std::numeric_limits<int32_t>::max();
  return static_cast<int32_t>(std::clamp(x, -kMost, kMost));
}

// Returns the box of lattice points around a world box: its corners, rounded outward.
IndexBox IndexBoxOf(const WorldBox& box, const GridTransform& grid) {
  const Basis dual = Dual(grid.basis);
  const std::array<Vec3d, 3> axes = {dual.a, dual.b, dual.c};
  IndexBox around;
  for (size_t m = 0; m < 3; ++m) {
    double low = std::numeric_limits<double>::infinity(), high = -low;
    for (size_t corner = 0; corner < 8; ++corner) {
      Vec3d offset;
      for (size_t n = 0; n < 3; ++n) offset[n] = ((corner >> n & 1) != 0 ? box.max : box.min)[n] - grid.origin[n];
      const double index = Dot(offset, axes[m]);
      low = std::min(low, index);
      high = std::max(high, index);
    }
    around.min[m] = ToIndex(std::floor(low));
    around.max[m] = ToIndex(std::ceil(high) + 1);
  }
  return around;
}

// Names the requested box, and that of the mesh in the same coordinates.
Warning EmptyBox(const VoxelizeRequest& request, const Accepted& accepted) {
  const WorldBox mesh{accepted.mesh.min, accepted.mesh.max};
  std::vector<std::string> boxes, names;
  if (request.region) {
    names.emplace_back("region");
    const std::string around = Corners(IndexBoxOf(mesh, accepted.grid));
    boxes.push_back(absl::StrCat("the region ", Corners(*request.region), " (the mesh lies about in ", around, ")"));
  }
  if (request.bounds) {
    names.emplace_back("bounds");
    boxes.push_back(absl::StrCat("the bounds ", Corners(*request.bounds), " (the mesh lies in ", Corners(mesh), ")"));
  }
  return {"EMPTY_RESULT", absl::StrCat("no voxel lies in ", absl::StrJoin(boxes, " and in ")),
          absl::StrJoin(names, ", ")};
}

std::string WhyNothingIsInside(const SolidFacts& solid, const GridTransform& grid) {
  if (solid.unbalanced_lines > 0) {
    return absl::StrCat("the mesh is not closed, and ", solid.unbalanced_lines, " lattice lines end unbalanced");
  }
  return absl::StrCat("no lattice point lies inside the mesh, which is thinner than their distances (voxel size ",
                      grid.voxel_size, ")", solid.rule == "positive" ? ", or turned inside out" : "");
}

// Precondition: the request has neither region nor bounds.
Warning EmptyWhole(const VoxelizeRequest& request, const Accepted& accepted, const Certificate& certificate) {
  if (const auto& shard = certificate.shard; shard && shard->count > 1) {
    return {"EMPTY_SHARD",
            absl::StrCat("shard ", shard->index, "/", shard->count, " has no voxel; others may have some"), "shard"};
  }
  if (const auto& band = certificate.band) {
    return {"EMPTY_RESULT", absl::StrCat("no lattice point lies within ", band->width, " of the mesh"), "band"};
  }
  if (const auto& solid = certificate.solid) {
    return {"EMPTY_RESULT", WhyNothingIsInside(*solid, accepted.grid), "solid"};
  }
  if (certificate.walk) {
    return {"EMPTY_RESULT",
            absl::StrCat("no lattice point is cut off by the mesh, or reached (voxel size ", accepted.grid.voxel_size,
                         "); a leak from a point inside shows why, and close may close it"),
            certificate.set};
  }
  if (const auto* links = std::get_if<Links>(&request.set); links != nullptr && links->side != LinkSide::kBoth) {
    return {"EMPTY_RESULT",
            absl::StrCat("no end of a step that the mesh crosses lies on this side of it (voxel size ",
                         accepted.grid.voxel_size, ")"),
            "links.side"};
  }
  return {"EMPTY_RESULT",
          absl::StrCat("the mesh crosses no step between neighboring lattice points (voxel size ",
                       accepted.grid.voxel_size, ")"),
          ""};
}

// Names the labels that enclose nothing: the first ones, and how many more there are.
std::optional<Warning> LabelsWithoutInside(const VoxelizeRequest& request, const WalkFacts& walk) {
  constexpr size_t kMostNamed = 8;
  std::vector<uint32_t> named;
  size_t count = 0;
  for (const LabelWalk& of_label : walk.labels) {
    if (of_label.cavities > 0) continue;
    if (++count <= kMostNamed) named.push_back(of_label.label);
  }
  if (count == 0) return std::nullopt;
  const std::string more = count > named.size() ? absl::StrCat(" and ", count - named.size(), " more") : "";
  return Warning{"LABEL_ENCLOSES_NOTHING",
                 absl::StrCat(NameOf(*std::get<Enclosed>(request.set).labels), " ", absl::StrJoin(named, ", "), more,
                              ": no lattice point is cut off; a leak from a point inside shows why, and close may "
                              "close it"),
                 "labels"};
}

double LongestSide(const MeshFacts& mesh) {
  double side = 0;
  for (size_t m = 0; m < 3; ++m) side = std::max(side, mesh.max[m] - mesh.min[m]);
  return side;
}

}  // namespace

std::vector<Warning> WarningsOf(const VoxelizeRequest& request, const Accepted& accepted, const Summary& summary) {
  constexpr double kFew = 4;
  std::vector<Warning> warnings;
  if (summary.voxels == 0) {
    warnings.push_back(request.region || request.bounds ? EmptyBox(request, accepted)
                                                        : EmptyWhole(request, accepted, summary.certificate));
  }
  if (const auto& walk = summary.certificate.walk) {
    if (auto warning = LabelsWithoutInside(request, *walk)) warnings.push_back(*std::move(warning));
  }
  const double side = LongestSide(accepted.mesh);
  if (!request.resolution && side < kFew * accepted.grid.voxel_size) {
    warnings.push_back({"FEW_VOXELS", absl::StrCat("the mesh is small: its longest side, ", side, ", is below ", kFew,
                                                   " voxel sizes of ", accepted.grid.voxel_size,
                                                   "; if its unit is another one, a scale converts it")});
  }
  return warnings;
}

}  // namespace latvox::client
