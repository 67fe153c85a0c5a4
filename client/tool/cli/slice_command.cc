#include "client/tool/cli/slice_command.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <optional>
#include <utility>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_join.h"
#include "client/internal/vec3.h"
#include "client/tool/cli/common_options.h"
#include "client/tool/cli/grid_input.h"
#include "client/tool/output/atomic_file.h"
#include "client/tool/output/cell_index.h"
#include "client/tool/output/field_columns.h"
#include "client/tool/output/output.h"
#include "client/tool/output/pixel_picture.h"
#include "client/tool/output/voxel_colors.h"
#include "latvox/for_each_voxel.h"
#include "latvox/grid/carried_names.h"
#include "latvox/grid/grid_content.h"

namespace latvox::client {
namespace {

const Names<size_t> kAxes = {{"x", 0}, {"y", 1}, {"z", 2}, {"i", 0}, {"j", 1}, {"k", 2}};

// Returns the two coordinates within a layer, in order.
std::pair<size_t, size_t> Others(size_t axis) { return {axis == 0 ? 1 : 0, axis == 2 ? 1 : 2}; }

// The layer in which the coordinate `axis` is `index`.
struct CutAt {
  size_t axis;
  int32_t index;
};

// Returns the voxels of a layer with their values.
GridContent Cut(const GridContent& content, const CutAt& place) {
  GridContent layer{{content.file.info, {}}, content.is_band, {}, content.distances, content.neighbors};
  for (const FieldValues& values : content.fields) {
    layer.fields.push_back({values.field, {}, values.neighbors, values.labels});
  }
  size_t voxel = 0;
  for (const Brick& brick : content.file.bricks) {
    Brick cut{brick.brick_ijk, {}};
    uint64_t any = 0;
    ForEachVoxel(brick, [&](const Vec3i& ijk) {
      const size_t here = voxel++;
      if (ijk[place.axis] != place.index) return;
      any |= cut.mask[WordInBrick(ijk)] |= BitInWord(ijk);
      for (size_t n = 0; n < content.fields.size(); ++n) AppendVoxel(content.fields[n], here, layer.fields[n]);
    });
    if (any != 0) layer.file.bricks.push_back(cut);
  }
  return layer;
}

// The part of a plane's world that a picture shows.
struct PlaneBox {
  Vec2d low, high;
};

// Returns the frame of the voxels, seen as in the layer.
PlaneBox FrameOf(const GridFile& file, const Layer& layer) {
  constexpr double kFar = std::numeric_limits<double>::max();
  PlaneBox frame{{kFar, kFar}, {-kFar, -kFar}};
  for (const Brick& brick : file.bricks) {
    ForEachVoxel(brick, [&](const Vec3i& ijk) {
      const Vec3d world = file.info.transform.ToWorld(ijk);
      const Vec2d at = {Dot(world, layer.right), Dot(world, layer.up)};
      for (size_t m = 0; m < 2; ++m) {
        frame.low[m] = std::min(frame.low[m], at[m] - layer.grid.pixel_size);
        frame.high[m] = std::max(frame.high[m], at[m] + layer.grid.pixel_size);
      }
    });
  }
  return frame;
}

// `colors` has one color per voxel of the cut, or is empty.
absl::StatusOr<std::string> Draw(const GridFile& file, const GridContent& cut, const std::vector<uint32_t>& colors,
                                 const CutAt& place, const SliceWords& words, const PictureStyle& style) {
  const Layer layer = LayerOf(file.info.transform, place.axis, place.index);
  const auto [first, second] = Others(place.axis);
  const PlaneBox frame = FrameOf(words.style.crop && !cut.file.bricks.empty() ? cut.file : file, layer);
  std::vector<PictureCell> cells;
  const FieldValues* const distances = FindField(cut.fields, Field::kDistance);
  for (const Brick& brick : cut.file.bricks) {
    ForEachVoxel(brick, [&, first = first, second = second](const Vec3i& ijk) {
      const size_t n = cells.size();
      PictureCell& cell = cells.emplace_back(PictureCell{{ijk[first], ijk[second]}});
      if (!colors.empty()) cell.color = colors[n];
      if (distances != nullptr) cell.inside = distances->As<float>()[n] < 0;
    });
  }
  return DrawCells(layer.grid, cells, frame.low, frame.high, words.size, style);
}

absl::StatusOr<std::unique_ptr<Output>> List(const std::string& path, const GridContent& cut) {
  VoxelizeRequest request;
  request.fields = TraitsOf(cut).fields;
  auto output = OpenOutput(path, request);
  if (!output.ok()) return output.status();
  (*output)->SetNames(ReadCarriedNames(cut.file.info));
  Accepted accepted;
  accepted.grid = cut.file.info.transform;
  accepted.neighbors = cut.neighbors;
  for (const FieldValues& values : cut.fields) {
    if (FactsOf(values.field).is_of_labels()) accepted.fraction_labels = values.labels;
  }
  if (auto status = (*output)->Begin(accepted); !status.ok()) return status;
  if (auto status = (*output)->Add(cut.Batch()); !status.ok()) return status;
  if (auto status = (*output)->Finish({}); !status.ok()) return status;
  return output;
}

// Returns the meaning of the colors.
std::string ColorsText(const ColorByWords& words, ColorBy by, const std::optional<DistanceRange>& range) {
  if (by != ColorBy::kDistance || !range) return ColoredText(words, by);
  const std::string width = absl::StrFormat("%g", range->most);
  return ColoredText(words, by) +
         (range->is_signed ? absl::StrCat(", from -", width, " (blue, inside) to ", width, " (red), a line at 0")
                           : absl::StrCat(", from 0 (violet) to ", width, " (yellow)"));
}

// Writes a file that appears in Commit.
absl::StatusOr<std::unique_ptr<AtomicFile>> WritePicture(const std::string& path, const std::string& png) {
  auto picture = AtomicFile::Create(path);
  if (!picture.ok()) return picture.status();
  if (auto status = (*picture)->Append(png); !status.ok()) return status;
  if (auto status = (*picture)->Sync(); !status.ok()) return status;
  return picture;
}

absl::StatusOr<CutAt> CutOf(const SliceWords& words, const GridFileInfo& info) {
  if (!info.active_box) return absl::InvalidArgumentError(absl::StrCat(words.input, ": has no voxels"));
  const size_t axis = ValueNamed(kAxes, words.axis);
  const int64_t low = info.active_box->min[axis], high = int64_t{info.active_box->max[axis]} - 1;
  if (!words.index) return CutAt{axis, static_cast<int32_t>(low + (high - low + 1) / 2)};
  if (*words.index >= low && *words.index <= high) return CutAt{axis, *words.index};
  return absl::InvalidArgumentError(absl::StrCat("--index ", *words.index, " is not among the layers ", low, " to ",
                                                 high, " across ", words.axis, " that ", words.input, " has"));
}

}  // namespace

void AddSliceOptions(CommandParser& command, SliceWords& words) {
  command.Add({GridFileRow(words.input),
               OutputRow({".png", ".csv"}, words.outputs, /*several=*/true),
               {.names = "--axis",
                .target = &words.axis,
                .help = "Lattice coordinate that is constant in the layer; x, y, z are other names of i, j, k",
                .words = WordsOf(kAxes),
                .word_help = {"i", "j", "k", "first lattice coordinate", "second", "third"},
                .standard = "z"},
               {.names = "--index",
                .target = &words.index,
                .help = "Value of that coordinate in the layer",
                .value = "N",
                .checks = {Whole(std::numeric_limits<int>::min(), std::numeric_limits<int>::max())},
                .standard = "the middle of the file's voxels"},
               SizeRow("Pixels along the picture's longer side", words.size)});
  command.Add(ColorByRows(words.color_by));
  AddPictureStyleOptions(command, "Show only the part of the world that the layer's voxels take", words.style);
}

void Check(const SliceWords& words) {
  Check(words.color_by);
  CheckOutputs(words.outputs, words.input, "file");
}

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
  const auto content = ReadInputContent(words.input, /*values=*/true, cancellation);
  if (!content.ok()) return content.status();
  const auto place = CutOf(words, content->file.info);
  if (!place.ok()) return place.status();
  const GridContent cut = Cut(*content, *place);
  GridContent drawn = cut;
  if (auto status = SelectLabel(words.color_by, words.input, drawn); !status.ok()) return status;
  const ColorBy by = ColorByOf(words.color_by, /*distances=*/true, drawn);
  const auto colors = FileColors(words.input, drawn, by);
  if (!colors.ok()) return colors.status();
  std::vector<std::unique_ptr<Output>> lists;
  std::vector<std::unique_ptr<AtomicFile>> pictures;
  for (const std::string& path : words.outputs) {
    if (absl::EndsWithIgnoreCase(path, ".csv")) {
      auto list = List(path, cut);
      if (!list.ok()) return list.status();
      lists.push_back(*std::move(list));
      continue;
    }
    const auto png = Draw(content->file, cut, *colors, *place, words, StyleOf(words.style, drawn, by));
    if (!png.ok()) return png.status();
    auto picture = WritePicture(path, *png);
    if (!picture.ok()) return picture.status();
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
  for (const Brick& brick : cut.file.bricks) ForEachVoxel(brick, [&](const Vec3i&) { ++voxels; });
  return absl::StrCat(words.input, ": ", voxels, " voxels in layer ", words.axis, " = ", place->index,
                      pictures.empty() ? "" : ColorsText(words.color_by, by, cut.distances), "\nwrote ",
                      absl::StrJoin(words.outputs, ", "), "\n");
}

}  // namespace latvox::client
