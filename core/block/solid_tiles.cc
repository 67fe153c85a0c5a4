#include "core/block/solid_tiles.h"

#include <algorithm>
#include <bit>
#include <cstdlib>
#include <cstring>
#include <string>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "core/brick/tile_order.h"
#include "core/solid/balance.h"
#include "core/solid/crossing_triangles.h"
#include "core/solid/labeled_interior.h"
#include "core/tile/cut_out.h"

namespace latvox {
namespace {

// Returns the end of the error of a mesh, or of a label, without an inside.
//   lines   "lattice lines", or those of a label
//   more    further facts
std::string NoInside(uint64_t unbalanced, const char* lines, const std::string& more, bool has_fraction) {
  const bool balanced = unbalanced == 0;
  const char* const advice = has_fraction ? "a fraction asks for a closed mesh"
                             : balanced   ? "force_open fills along these lines"
                                          : "force_open fills the others";
  return balanced ? absl::StrFormat(", although all %s along k end balanced%s; %s", lines, more, advice)
                  : absl::StrFormat(", and %d %s along k end unbalanced%s; %s", unbalanced, lines, more, advice);
}

BitsLayout LayoutOf(const Vec3i& tile_ijk) { return {tile_ijk * kTileSide, {}}; }

}  // namespace

// A closed mesh is balanced on every line. For another mesh, all lines must be checked.
absl::StatusOr<std::unique_ptr<const Interior>> MakeInterior(const SnappedMesh& mesh, const Solid& solid,
                                                             bool has_fraction, bool closed, const IndexBox& region,
                                                             StopSignal stop, InteriorRule& rule,
                                                             uint64_t& unbalanced_lines) {
  const bool oriented = solid.rule != InteriorRule::kParity && IsOriented(mesh, stop);
  rule = RuleFor(solid.rule, oriented);
  const bool has_inside = rule == InteriorRule::kParity ? closed : oriented;
  unbalanced_lines = has_inside ? 0 : CountUnbalancedLines(mesh, rule, stop);
  if (!has_inside && !solid.force_open && !stop.Stopped()) {
    return absl::InvalidArgumentError(absl::StrCat("mesh: it is not closed", WithoutOrientation(closed, rule),
                                                   NoInside(unbalanced_lines, "lattice lines", "", has_fraction)));
  }
  std::unique_ptr<const Interior> interior =
      has_inside ? MakeClosedInterior(mesh, rule, region, stop) : MakeOpenInterior(mesh, rule, region, stop);
  if (stop.Stopped()) return absl::CancelledError("voxelization cancelled");
  return interior;
}

absl::StatusOr<std::unique_ptr<const Interior>> MakeLabeledInterior(const SnappedMesh& mesh, const Labels& labels,
                                                                    const Solid& solid, bool has_fraction,
                                                                    const IndexBox& region, StopSignal stop,
                                                                    InteriorRule& rule, uint64_t& unbalanced_lines) {
  const LabelBalance balance = BalanceOfLabels(mesh, labels, solid, stop);
  rule = balance.rule;
  unbalanced_lines = balance.unbalanced_lines;
  const bool has_inside = balance.open_labels == 0;
  if (!has_inside && !solid.force_open && !stop.Stopped()) {
    return absl::InvalidArgumentError(absl::StrCat(
        absl::StrFormat("mesh: %s %d is not closed", NameOf(labels.field), balance.first_open),
        WithoutOrientation(balance.first_closed, rule),
        NoInside(
            balance.first_lines, "of its lattice lines",
            balance.open_labels == 1 ? "" : absl::StrCat("; ", balance.open_labels, " labels in all have no inside"),
            has_fraction)));
  }
  std::unique_ptr<const Interior> interior = has_inside ? MakeClosedLabeledInterior(mesh, labels, rule, region, stop)
                                                        : MakeOpenLabeledInterior(mesh, labels, rule, region, stop);
  if (stop.Stopped()) return absl::CancelledError("voxelization cancelled");
  return interior;
}

bool HasAxes(const std::vector<Frame>& frames) {
  return std::count_if(frames.begin(), frames.end(), [](const Frame& frame) {
           return std::abs(frame.q[0]) + std::abs(frame.q[1]) + std::abs(frame.q[2]) == 1;
         }) == 3;
}

SolidTiles::SolidTiles() : bits_(LayoutOf({}).Words()) {}

// Gives each tile the triangles that may cross a line along an axis, and whose bounding boxes meet the box around its
// lattice points.
void SolidTiles::Sort(const SnappedMesh& mesh, const TileNode& node, StopSignal stop) {
  constexpr int kTileUnitBits = kSubvoxelBits + kTileBits;
  triangles_.resize(size_t{1} << 3 * node.level);
  for (std::vector<uint32_t>& list : triangles_) list.clear();
  FindCrossing(mesh, node.triangles, stop, crossing_);
  for (const uint32_t t : crossing_) {
    if (stop.Stopped()) return;
    const auto& [a, b, c] = mesh.triangles[t];
    const Vec3i &va = mesh.vertices_lat[a], &vb = mesh.vertices_lat[b], &vc = mesh.vertices_lat[c];
    Vec3i first, last;
    for (size_t m = 0; m < 3; ++m) {
      const int32_t least = std::min(std::min(va[m], vb[m]), vc[m]), most = std::max(std::max(va[m], vb[m]), vc[m]);
      first[m] = std::max(((least + kLatticeUnit - 1) >> kTileUnitBits) - node.tile_ijk[m], 0);
      last[m] = std::min((most >> kTileUnitBits) - node.tile_ijk[m], (1 << node.level) - 1);
    }
    for (int32_t i = first[0]; i <= last[0]; ++i) {
      for (int32_t j = first[1]; j <= last[1]; ++j) {
        for (int32_t k = first[2]; k <= last[2]; ++k) triangles_[TileNumber({i, j, k})].push_back(t);
      }
    }
  }
}

// Without a margin, a tile's rows follow each other in its bits.
TileBricks SolidTiles::CutOut(const TileContext& context, const Interior& interior, size_t number,
                              const Vec3i& tile_ijk, BlockVoxels* surface) {
  const std::span<const uint64_t> rows = RowsOf(interior, number, tile_ijk);
  TileBricks tile;
  if (surface != nullptr) {
    surface->AddRows(tile_ijk, rows);
    tile = surface->CutOut(context, tile_ijk);
  } else {
    static_assert(std::endian::native == std::endian::little, "words of both sizes are read as bytes");
    std::memcpy(bits_.words().data(), rows.data(), rows.size_bytes());
    tile = latvox::CutOut(LayoutOf(tile_ijk), bits_, tile_ijk * kTileSide, context.region, context.mesh.base_ijk);
  }
  tile.labels = std::exchange(rows_.labels(), {});
  return tile;
}

size_t SolidTiles::Bytes() const {
  size_t bytes = BytesOf(crossing_) + BytesOf(triangles_) + rows_.Bytes() + bits_.Bytes();
  for (const std::vector<uint32_t>& list : triangles_) bytes += BytesOf(list);
  return bytes;
}

}  // namespace latvox
