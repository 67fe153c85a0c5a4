#include "core/walk/tile_pieces.h"

#include <algorithm>

namespace latvox {
void PieceScan::FindOnly(const WalkSteps& steps, const HaloBox& box, std::span<const WideRow> walls) {
  const WideRow all = FirstBits(box.side[2]);
  free_.resize(walls.size());
  std::transform(walls.begin(), walls.end(), free_.begin(), [all](WideRow row) { return ~row & all; });
  pieces_.Find(free_, box.side[1], steps.along_k);
}

TilePieces PieceScan::Find(const WalkSteps& steps, const HaloBox& box, std::span<const WideRow> walls,
                           const IndexBox& mesh_box) {
  FindOnly(steps, box, walls);
  TilePieces out;
  for (size_t axis = 0; axis < 3; ++axis) {
    for (const size_t side : {0U, 1U}) {
      AddPatches(steps, box, axis, side, out.numbers_);
      out.patches_ends_[2 * axis + side] = static_cast<uint32_t>(out.numbers_.size());
    }
  }
  const size_t first = out.numbers_.size();
  out.numbers_.resize(first + 2 * size_t{pieces_.count()});
  out.numbers_.shrink_to_fit();
  CountPoints(box, mesh_box, std::span(out.numbers_).subspan(first));
  return out;
}

// Rows that repeat are counted together.
//   numbers   of pieces: their points in the tile, and whether they have others outside of the mesh's box
void PieceScan::CountPoints(const HaloBox& box, const IndexBox& mesh_box, std::span<uint32_t> numbers) const {
  const Vec3i high = box.low + box.side - Vec3i{1, 1, 1};
  const bool all_in_box = mesh_box.Contains(box.low) && mesh_box.Contains(high);
  for (int32_t i = 0; i < box.side[0]; ++i) {
    const bool plane_in_tile = i >= box.halo[0] && i < box.side[0] - box.halo[0];
    for (int32_t j = 0, end = 0; j < box.side[1]; j = end) {
      for (end = j + 1; end < box.side[1] && pieces_.Repeats(box.RowOf(i, end));) ++end;
      const std::span<const FreeRun> runs = pieces_.RunsOf(box.RowOf(i, j));
      const int32_t rows = std::min(end, box.side[1] - box.halo[1]) - std::max(j, box.halo[1]);
      if (plane_in_tile && rows > 0) {
        for (const FreeRun& run : runs) {
          const int32_t first = std::max(run.first, box.halo[2]);
          const int32_t last = std::min(run.last, box.halo[2] + kTileSide - 1);
          numbers[2 * size_t{run.piece}] += static_cast<uint32_t>(rows * std::max(last - first + 1, 0));
        }
      }
      if (all_in_box) continue;
      const Vec3i at = box.low + Vec3i{i, j, 0};
      const bool rows_in_box = mesh_box.Contains({at[0], at[1], mesh_box.min[2]}) &&
                               mesh_box.Contains({at[0], at[1] + end - 1 - j, mesh_box.min[2]});
      for (const FreeRun& run : runs) {
        if (!rows_in_box || at[2] + run.first < mesh_box.min[2] || at[2] + run.last >= mesh_box.max[2]) {
          numbers[2 * size_t{run.piece} + 1] = 1;
        }
      }
    }
  }
}

// The rows of a slab across i or j lie along k, and those of a slab across k lie along j, so that they are few. A slab
// without walls is one patch if basis vectors are steps.
void PieceScan::AddPatches(const WalkSteps& steps, const HaloBox& box, size_t axis, size_t side,
                           std::vector<uint32_t>& numbers) {
  const int32_t thickness = 2 * box.halo[axis], low = side == 0 ? 0 : box.side[axis] - thickness;
  const WideRow all = FirstBits(box.side[2]);
  slab_.clear();
  if (axis == 2) {
    slab_.assign(static_cast<size_t>(thickness) * static_cast<size_t>(box.side[0]), FirstBits(box.side[1]));
    const WideRow slab = FirstBits(thickness) << low;
    bool has_walls = false;
    for (int32_t i = 0; i < box.side[0]; ++i) {
      for (int32_t j = 0; j < box.side[1]; ++j) {
        WideRow walls = ~free_[box.RowOf(i, j)] & slab;  // most rows have none
        for (; walls != 0; walls &= walls - 1) {
          slab_[static_cast<size_t>((LowestBit(walls) - low) * box.side[0] + i)] &= ~(WideRow{1} << j);
          has_walls = true;
        }
      }
    }
    if (!has_walls && steps.slack == Vec3i{}) return numbers.push_back(pieces_.PieceAt(0, low));
    patches_.Find(slab_, box.side[0], steps.across_k);
  } else {
    const int32_t planes = axis == 0 ? thickness : box.side[0], rows = axis == 1 ? thickness : box.side[1];
    for (int32_t i = 0; i < planes; ++i) {
      const size_t first = box.RowOf(axis == 0 ? low + i : i, axis == 1 ? low : 0);
      slab_.insert(slab_.end(), free_.begin() + static_cast<ptrdiff_t>(first),
                   free_.begin() + static_cast<ptrdiff_t>(first) + rows);
    }
    const bool is_free = std::ranges::all_of(slab_, [all](WideRow row) { return row == all; });
    if (is_free && steps.slack == Vec3i{}) {
      return numbers.push_back(pieces_.PieceAt(axis == 0 ? box.RowOf(low, 0) : box.RowOf(0, low), 0));
    }
    patches_.Find(slab_, rows, steps.along_k);
  }
  uint32_t next = 0;  // patches are numbered in the order of their first runs
  for (size_t row = 0; row < patches_.rows(); ++row) {
    for (const FreeRun& run : patches_.RunsOf(row)) {
      if (run.piece != next) continue;
      ++next;
      const auto at = static_cast<int32_t>(row);
      if (axis == 2) {
        numbers.push_back(pieces_.PieceAt(box.RowOf(at % box.side[0], run.first), low + at / box.side[0]));
      } else {
        const int32_t rows = axis == 1 ? thickness : box.side[1];
        const int32_t i = at / rows + (axis == 0 ? low : 0), j = at % rows + (axis == 1 ? low : 0);
        numbers.push_back(pieces_.PieceAt(box.RowOf(i, j), run.first));
      }
    }
  }
}

}  // namespace latvox
