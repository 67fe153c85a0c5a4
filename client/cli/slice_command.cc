#include "client/cli/slice_command.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <utility>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "client/cli/common_options.h"
#include "client/grid/voxel_grid.h"
#include "client/output/atomic_file.h"
#include "client/output/cell_index.h"
#include "client/output/output.h"
#include "client/output/pixel_picture.h"
#include "client/output/vec3.h"
#include "client/output/voxel_walk.h"

namespace latvox::client {
namespace {

const Names<size_t> kAxes = {{"x", 0}, {"y", 1}, {"z", 2}, {"i", 0}, {"j", 1}, {"k", 2}};

// The coordinates within a layer, in their order.
std::pair<size_t, size_t> Others(size_t axis) { return {axis == 0 ? 1 : 0, axis == 2 ? 1 : 2}; }

// The voxels of a layer.
std::vector<Brick> Cut(const std::vector<Brick>& bricks, size_t axis, int32_t index) {
  std::vector<Brick> layer;
  for (const Brick& brick : bricks) {
    if (brick.brick_ijk[axis] != index >> 3) continue;
    Brick cut{brick.brick_ijk, {}};
    uint64_t any = 0;
    ForEachVoxel(brick, [&](const Vec3i& ijk) {
      if (ijk[axis] != index) return;
      any |= cut.mask[WordInBrick(ijk)] |= BitInWord(ijk);
    });
    if (any != 0) layer.push_back(cut);
  }
  return layer;
}

absl::StatusOr<std::string> Draw(const GridFile& file, const std::vector<Brick>& cut, size_t axis,
                                 const SliceWords& words) {
  const Layer layer = LayerOf(file.info.transform, axis, words.index);
  const auto [first, second] = Others(axis);
  constexpr double kFar = std::numeric_limits<double>::max();
  Vec2d low = {kFar, kFar}, high = {-kFar, -kFar};
  for (const Brick& brick : file.bricks) {
    ForEachVoxel(brick, [&](const Vec3i& ijk) {
      const Vec3d world = file.info.transform.ToWorld(ijk);
      const Vec2d at = {Dot(world, layer.right), Dot(world, layer.up)};
      for (size_t m = 0; m < 2; ++m) {
        low[m] = std::min(low[m], at[m] - layer.grid.pixel_size);
        high[m] = std::max(high[m], at[m] + layer.grid.pixel_size);
      }
    });
  }
  std::vector<Vec2i> cells;
  for (const Brick& brick : cut) {
    ForEachVoxel(brick, [&, first = first, second = second](const Vec3i& ijk) {
      cells.push_back({ijk[first], ijk[second]});
    });
  }
  return DrawCells(layer.grid, cells, low, high, words.size);
}

absl::StatusOr<std::unique_ptr<Output>> List(const std::string& path, const GridFile& file,
                                             const std::vector<Brick>& cut) {
  auto output = OpenOutput(path);
  if (!output.ok()) return output.status();
  Accepted accepted;
  accepted.grid = file.info.transform;
  if (auto status = (*output)->Begin(accepted); !status.ok()) return status;
  if (auto status = (*output)->Add({cut, 1}); !status.ok()) return status;
  if (auto status = (*output)->Finish({}); !status.ok()) return status;
  return output;
}

absl::Status CheckIndex(const SliceWords& words, const GridFileInfo& info, size_t axis) {
  if (!info.active_box) return absl::InvalidArgumentError(absl::StrCat(words.input, ": has no voxel"));
  const int64_t low = info.active_box->min[axis], high = int64_t{info.active_box->max[axis]} - 1;
  if (words.index >= low && words.index <= high) return absl::OkStatus();
  return absl::InvalidArgumentError(absl::StrCat("--index ", words.index, " is not of the layers ", low, " to ", high,
                                                 " across ", words.axis, " that ", words.input, " has"));
}

}  // namespace

void AddSliceOptions(CLI::App& command, SliceWords& words) {
  command.add_option("file", words.input, "a .vdb file")->type_name("IN.vdb")->required();
  AddOutputOption(command, {".png", ".csv"}, words.outputs);
  command
      .add_option("--axis", words.axis,
                  "across which the layer lies: lattice coordinate i, j or k, or x, y, z for these")
      ->type_name("AXIS")
      ->required()
      ->check(OneOf(kAxes));
  command.add_option("--index", words.index, "the layer's lattice coordinate on that axis")
      ->type_name("N")
      ->required()
      ->check(Whole(std::numeric_limits<int>::min(), std::numeric_limits<int>::max()));
  AddSizeOption(command, "pixels of the picture's longer side", words.size);
}

void Check(const SliceWords& words) { CheckOutputs(words.outputs, words.input, "file"); }

Layer LayerOf(const GridTransform& grid, size_t axis, int32_t index) {
  const Vec3d* const basis[] = {&grid.basis.a, &grid.basis.b, &grid.basis.c};
  const auto [first, second] = Others(axis);
  const Vec3d &u = *basis[first], &v = *basis[second];
  Layer layer;
  layer.right = Unit(u);
  layer.up = Unit(Sum(v, -Dot(v, layer.right), layer.right));
  Vec3i corner{};
  corner[axis] = index;
  const Vec3d origin = grid.ToWorld(corner);
  layer.grid.basis = {{Length(u), 0}, {Dot(v, layer.right), Dot(v, layer.up)}};
  layer.grid.origin = {Dot(origin, layer.right), Dot(origin, layer.up)};
  layer.grid.pixel_size = std::sqrt(Length(u) * Dot(v, layer.up));
  return layer;
}

absl::StatusOr<std::string> RunSlice(const SliceWords& words, const Cancellation& cancellation) {
  const size_t axis = ValueNamed(kAxes, words.axis);
  const auto file = ReadGridFile(words.input);
  if (!file.ok()) return file.status();
  if (auto status = CheckIndex(words, file->info, axis); !status.ok()) return status;
  const std::vector<Brick> cut = Cut(file->bricks, axis, words.index);
  std::vector<std::unique_ptr<Output>> lists;
  std::vector<std::unique_ptr<AtomicFile>> pictures;
  for (const std::string& path : words.outputs) {
    if (absl::EndsWithIgnoreCase(path, ".csv")) {
      auto list = List(path, *file, cut);
      if (!list.ok()) return list.status();
      lists.push_back(*std::move(list));
      continue;
    }
    auto picture = AtomicFile::Create(path);
    if (!picture.ok()) return picture.status();
    const auto png = Draw(*file, cut, axis, words);
    if (!png.ok()) return png.status();
    if (auto status = (*picture)->Append(*png); !status.ok()) return status;
    if (auto status = (*picture)->Sync(); !status.ok()) return status;
    pictures.push_back(*std::move(picture));
  }
  if (cancellation.cancelled()) return absl::CancelledError("cancelled");
  for (const auto& list : lists) {
    if (auto status = list->Commit(); !status.ok()) return status;
  }
  for (const auto& picture : pictures) {
    if (auto status = picture->Commit(); !status.ok()) return status;
  }
  uint64_t voxels = 0;
  for (const Brick& brick : cut) ForEachVoxel(brick, [&](const Vec3i&) { ++voxels; });
  return absl::StrCat(words.input, ": ", voxels, " voxels in layer ", words.axis, " = ", words.index, "\nwrote ",
                      absl::StrJoin(words.outputs, ", "), "\n");
}

}  // namespace latvox::client
