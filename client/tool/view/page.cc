#include "client/tool/view/page.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdlib>
#include <vector>

#include "absl/strings/escaping.h"
#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "absl/strings/str_replace.h"
#include "absl/strings/string_view.h"
#include "client/internal/vec3.h"
#include "client/json/json.h"
#include "client/tool/output/file_metadata.h"
#include "client/tool/output/voronoi_cell.h"
#include "client/tool/view/paints.h"
#include "latvox/error.h"
#include "latvox/for_each_voxel.h"

// Embeds the files of this folder unchanged.
#define LATVOX_EMBED(name, file)                                                                                       \
  asm(".pushsection .rodata\n.global " #name "\n.global " #name "_end\n" #name ":\n.incbin \"" LATVOX_VIEW_FOLDER file \
      "\"\n" #name "_end:\n.popsection\n");                                                                            \
  extern "C" const char name[], name##_end[]
LATVOX_EMBED(latvox_view_page, "/page.html");
LATVOX_EMBED(latvox_view_three, "/three.js");
LATVOX_EMBED(latvox_view_voxels, "/voxels.js");
LATVOX_EMBED(latvox_view_cells, "/cells.js");
LATVOX_EMBED(latvox_view_facets, "/facets.js");
LATVOX_EMBED(latvox_view_surface, "/surface.js");
LATVOX_EMBED(latvox_view_data, "/data.js");
LATVOX_EMBED(latvox_view_flat, "/flat.js");
LATVOX_EMBED(latvox_view_view, "/view.js");
LATVOX_EMBED(latvox_view_controls, "/controls.js");

namespace latvox::client {
namespace {

static_assert(std::endian::native == std::endian::little && sizeof(Brick::brick_ijk) + sizeof(Brick::mask) == 76);

constexpr int64_t kMaxSide = 65536;
constexpr int32_t kMaxStep = 8;  // reach of voxels.js

Json MetadataOf(const GridFileInfo& info) {
  Json metadata = Json::array();
  for (const auto& [name, value] : info.metadata) {
    if (absl::StartsWith(name, "latvox_")) metadata.push_back({name.substr(7), value});
  }
  return metadata;
}

absl::Status BeyondPage(const std::string& what, const std::string& value, uint64_t limit) {
  absl::Status status =
      absl::ResourceExhaustedError(absl::StrCat(what, " exceed the limit of ", limit,
                                                " of a page; voxelize a part (--bounds, --region), or more coarsely "
                                                "(--resolution, --voxel-size), or draw a .png"));
  SetErrorDetails({"LIMIT_EXCEEDED", "--out", value, absl::StrCat(limit), std::nullopt}, status);
  return status;
}

absl::Status CheckSize(const GridFileInfo& info, const IndexBox& box) {
  if (info.active_voxels > kMaxPageVoxels) {
    return BeyondPage(absl::StrCat(info.active_voxels, " voxels"), absl::StrCat(info.active_voxels), kMaxPageVoxels);
  }
  for (size_t m = 0; m < 3; ++m) {
    if (const int64_t side = int64_t{box.max[m]} - box.min[m]; side > kMaxSide) {
      return BeyondPage(absl::StrCat(side, " voxels on axis ", std::string(1, "ijk"[m])), absl::StrCat(side), kMaxSide);
    }
  }
  return absl::OkStatus();
}

absl::Status CheckSteps(const VoronoiCell& cell) {
  for (const CellFace& face : cell.faces) {
    for (const int32_t n : face.neighbor) {
      if (std::abs(n) <= kMaxStep) continue;
      return absl::ResourceExhaustedError(absl::StrCat("the step ", absl::StrJoin(face.neighbor, ","),
                                                       " to a neighbor exceeds the limit of ", kMaxStep,
                                                       " of a page; use a less skewed basis of the same lattice"));
    }
  }
  return absl::OkStatus();
}

Json FacetsOf(const VoronoiCell& cell, const Basis& basis) {
  Json facets = Json::array();
  for (const CellFace& face : cell.faces) {
    const Vec3i& w = face.neighbor;
    Json corners = Json::array();
    for (const int n : face.corners) corners.push_back(cell.corners[static_cast<size_t>(n)]);
    const Vec3d to = Combine(basis, {double(w[0]), double(w[1]), double(w[2])});
    facets.push_back({{"step", w}, {"normal", Unit(to)}, {"corners", corners}});
  }
  return facets;
}

// Returns a direction of the world in the view, where y is up. x stays on the right if z is up.
Vec3d ToYUp(const Vec3d& v, UpAxis up) {
  if (up == UpAxis::kY) return v;
  return up == UpAxis::kZ ? Vec3d{v[0], v[2], -v[1]} : Vec3d{v[2], v[0], v[1]};
}

Basis BasisToYUp(const Basis& basis, UpAxis up) { return {ToYUp(basis.a, up), ToYUp(basis.b, up), ToYUp(basis.c, up)}; }

// Places the voxels within distance 1 of 0.
struct Place {
  Basis basis;
  Vec3d middle{};  // lattice coordinates relative to the low corner of the box
};

Place PlacementOf(const GridFile& file, const IndexBox& box) {
  const GridTransform& grid = file.info.transform;
  Vec3d low = grid.ToWorld(box.min), high = low;
  const auto visit = [&](const auto& each) {
    for (const Brick& brick : file.bricks) ForEachVoxel(brick, [&](const Vec3i& ijk) { each(grid.ToWorld(ijk)); });
  };
  bool first = true;
  visit([&](const Vec3d& at) {
    for (size_t m = 0; m < 3; ++m) {
      low[m] = first ? at[m] : std::min(low[m], at[m]);
      high[m] = first ? at[m] : std::max(high[m], at[m]);
    }
    first = false;
  });
  const Vec3d center = Sum(low, 0.5, Sum(high, -1, low));
  double radius = 0;
  visit([&](const Vec3d& at) { radius = std::max(radius, Length(Sum(at, -1, center))); });
  radius += Length(grid.basis.a) + Length(grid.basis.b) + Length(grid.basis.c);
  const Basis dual = Dual(grid.basis);
  const Vec3d from_low = Sum(center, -1, grid.ToWorld(box.min));
  return {{Sum({}, 1 / radius, grid.basis.a), Sum({}, 1 / radius, grid.basis.b), Sum({}, 1 / radius, grid.basis.c)},
          {Dot(dual.a, from_low), Dot(dual.b, from_low), Dot(dual.c, from_low)}};
}

absl::string_view Embedded(const char* begin, const char* end) { return {begin, static_cast<size_t>(end - begin)}; }

std::string Bytes(const std::vector<Brick>& bricks) {
  std::string bytes;
  bytes.reserve(76 * bricks.size());
  for (const Brick& brick : bricks) {
    bytes.append(reinterpret_cast<const char*>(brick.brick_ijk.data()), sizeof(brick.brick_ijk));
    bytes.append(reinterpret_cast<const char*>(brick.mask.data()), sizeof(brick.mask));
  }
  return bytes;
}

const char* KindOf(const Paint& paint) {
  if (paint.is_mix) return "none";
  if (paint.values.empty()) return "rgb";
  return paint.has_floats ? "float32" : "uint32";
}

Json Describe(const std::vector<Paint>& paints) {
  Json described = Json::array();
  for (const Paint& paint : paints) {
    described.push_back({{"name", paint.name},
                         {"ramp", paint.is_ramp},
                         {"legend", paint.legend},
                         {"values", KindOf(paint)},
                         {"components", paint.components}});
  }
  return described;
}

// Returns the template with the data and the scripts in their places.
std::string Fill(const Json& data, const std::vector<Brick>& bricks, const std::vector<Paint>& paints) {
  // Escapes "<", so that no tag can begin within the JSON.
  const std::string json =
      absl::StrReplaceAll(data.dump(-1, ' ', true, Json::error_handler_t::replace), {{"<", "\\u003c"}});
  std::string colors, values;
  for (const Paint& paint : paints) {
    colors += paint.bytes;
    values += paint.values;
  }
  return absl::StrReplaceAll(Embedded(latvox_view_page, latvox_view_page_end),
                             {{"{{data}}", json},
                              {"{{bricks}}", absl::Base64Escape(Bytes(bricks))},
                              {"{{colors}}", absl::Base64Escape(colors)},
                              {"{{values}}", absl::Base64Escape(values)},
                              {"{{three}}", Embedded(latvox_view_three, latvox_view_three_end)},
                              {"{{voxels}}", Embedded(latvox_view_voxels, latvox_view_voxels_end)},
                              {"{{cells}}", Embedded(latvox_view_cells, latvox_view_cells_end)},
                              {"{{facets}}", Embedded(latvox_view_facets, latvox_view_facets_end)},
                              {"{{surface}}", Embedded(latvox_view_surface, latvox_view_surface_end)},
                              {"{{data_js}}", Embedded(latvox_view_data, latvox_view_data_end)},
                              {"{{flat}}", Embedded(latvox_view_flat, latvox_view_flat_end)},
                              {"{{view}}", Embedded(latvox_view_view, latvox_view_view_end)},
                              {"{{controls}}", Embedded(latvox_view_controls, latvox_view_controls_end)}});
}

}  // namespace

absl::StatusOr<std::string> ViewPage(const GridContent& content, const std::string& title, UpAxis up) {
  const GridFile& file = content.file;
  const IndexBox box = file.info.active_box.value_or(IndexBox{{0, 0, 0}, {1, 1, 1}});
  if (auto status = CheckSize(file.info, box); !status.ok()) return status;
  const auto paints = PaintsOf(content);
  if (!paints.ok()) return paints.status();
  const Place placement = PlacementOf(file, box);
  const Basis basis = BasisToYUp(placement.basis, up);
  const VoronoiCell cell = VoronoiCellOf(basis);
  if (auto status = CheckSteps(cell); !status.ok()) return status;
  const GridTransform& grid = file.info.transform;
  const Json data = {{"title", title},
                     {"voxels", file.info.active_voxels},
                     {"metadata", MetadataOf(file.info)},
                     {"voxels", file.info.active_voxels},
                     {"low", box.min},
                     {"high", box.max},
                     {"grid", {{"origin", grid.origin}, {"basis", {grid.basis.a, grid.basis.b, grid.basis.c}}}},
                     {"axes", {ToYUp({1, 0, 0}, up), ToYUp({0, 1, 0}, up), ToYUp({0, 0, 1}, up)}},
                     {"basis", {basis.a, basis.b, basis.c}},
                     {"middle", placement.middle},
                     {"facets", FacetsOf(cell, basis)},
                     {"paints", Describe(*paints)},
                     {"band", HoldsBand(content)}};
  return Fill(data, file.bricks, *paints);
}

}  // namespace latvox::client
