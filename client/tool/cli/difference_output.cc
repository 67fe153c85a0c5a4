#include "client/tool/cli/difference_output.h"

#include <algorithm>
#include <cstdint>
#include <utility>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "client/grid/difference_file.h"
#include "client/tool/cli/brick_pairs.h"
#include "client/tool/cli/value_difference.h"
#include "client/tool/output/cell_index.h"
#include "client/tool/output/picture.h"
#include "client/tool/output/picture_scene.h"
#include "client/tool/vdb/vdb.h"
#include "latvox/for_each_voxel.h"

namespace latvox::client {
namespace {

struct MarkColor {
  DifferenceMark mark;
  uint32_t color;  // red << 16 | green << 8 | blue
  const char* name;
};

// Red and blue of ColorBrewer's RdBu, which color-blind people can tell apart.
constexpr MarkColor kColors[] = {{DifferenceMark::kSame, 0xB8B8B8, "gray"},
                                 {DifferenceMark::kOnlyA, 0xCA2A36, "red"},
                                 {DifferenceMark::kOnlyB, 0x2166AC, "blue"},
                                 {DifferenceMark::kOtherValues, 0xE8A33D, "orange"}};

// All voxels of both files with their marks, and the distances that differ.
struct MarkedVoxels {
  std::vector<Brick> bricks;
  std::vector<DifferenceMark> marks;  // of each voxel
  std::vector<float> changes;         // with distances in both files: of each voxel with other values
};

class Marking {
 public:
  Marking(const GridContent& a, const GridContent& b, bool values)
      : a_(a), b_(b), fields_(values ? CommonFields(a, b) : std::vector<CommonField>{}) {
    const auto has_distances = [](const CommonField& field) { return field.a->field == Field::kDistance; };
    const auto found = std::ranges::find_if(fields_, has_distances);
    if (found != fields_.end()) distances_ = &*found;
  }

  MarkedVoxels Mark() {
    ForEachPair(a_.file.bricks, b_.file.bricks, [&](const Brick* of_a, const Brick* of_b) {
      constexpr decltype(Brick::mask) kNone{};
      const auto &in_a = of_a ? of_a->mask : kNone, &in_b = of_b ? of_b->mask : kNone;
      Brick any{of_a ? of_a->brick_ijk : of_b->brick_ijk, {}};
      for (size_t x = 0; x < 8; ++x) any.mask[x] = in_a[x] | in_b[x];
      ForEachVoxel(any, [&](const Vec3i& ijk) { AddVoxel(HasVoxel(in_a, ijk), HasVoxel(in_b, ijk)); });
      found_.bricks.push_back(any);
    });
    return std::move(found_);
  }

 private:
  void AddVoxel(bool in_a, bool in_b) {
    DifferenceMark mark = in_a ? DifferenceMark::kOnlyA : DifferenceMark::kOnlyB;
    if (in_a && in_b) mark = HasOtherValues() ? DifferenceMark::kOtherValues : DifferenceMark::kSame;
    found_.marks.push_back(mark);
    m_ += in_a;
    n_ += in_b;
  }

  // Compares the voxel m_ of A with the voxel n_ of B.
  bool HasOtherValues() {
    const auto differs = [this](const CommonField& field) { return field.Differs(m_, n_); };
    if (std::ranges::none_of(fields_, differs)) return false;
    if (distances_ != nullptr) {
      found_.changes.push_back(distances_->b->As<float>()[n_] - distances_->a->As<float>()[m_]);
    }
    return true;
  }

  const GridContent &a_, &b_;
  const std::vector<CommonField> fields_;
  const CommonField* distances_ = nullptr;  // of `fields_`
  size_t m_ = 0, n_ = 0;                    // voxels passed
  MarkedVoxels found_;
};

// Returns the voxels for which `wanted` is true of their mark.
template <class Wanted>
std::vector<Brick> Only(const MarkedVoxels& all, const Wanted& wanted) {
  std::vector<Brick> some;
  auto mark = all.marks.begin();
  for (const Brick& brick : all.bricks) {
    Brick part{brick.brick_ijk, {}};
    bool any = false;
    ForEachVoxel(brick, [&](const Vec3i& ijk) {
      if (!wanted(*mark++)) return;
      part.mask[WordInBrick(ijk)] |= BitInWord(ijk);
      any = true;
    });
    if (any) some.push_back(part);
  }
  return some;
}

GridDifference DifferenceOf(const MarkedVoxels& all, const CompareWords& words, bool has_distances) {
  GridDifference difference{words.a, words.b, {}, {}, has_distances, {}, {}};
  difference.bricks = Only(all, [](DifferenceMark mark) { return mark != DifferenceMark::kSame; });
  for (const DifferenceMark mark : all.marks) {
    if (mark != DifferenceMark::kSame) difference.marks.push_back(static_cast<uint32_t>(mark));
  }
  if (!has_distances) return difference;
  difference.changed = Only(all, [](DifferenceMark mark) { return mark == DifferenceMark::kOtherValues; });
  difference.changes = all.changes;
  return difference;
}

// Leaves out other values where there are none.
Legend LegendOfMarks(const std::vector<DifferenceMark>& marks) {
  Legend legend;
  for (const MarkColor& each : kColors) {
    const auto voxels = std::count(marks.begin(), marks.end(), each.mark);
    if (voxels == 0 && each.mark == DifferenceMark::kOtherValues) continue;
    legend.entries.push_back(
        {each.color, absl::StrCat(NameOf(each.mark), ": ", voxels, voxels == 1 ? " voxel" : " voxels")});
  }
  return legend;
}

absl::StatusOr<std::string> Draw(const MarkedVoxels& all, const GridTransform& transform,
                                 const Cancellation& cancellation) {
  PictureOptions options;
  options.cancellation = cancellation;
  options.style.legend = LegendOfMarks(all.marks);
  std::vector<uint32_t> colors;
  for (const DifferenceMark mark : all.marks) colors.push_back(kColors[static_cast<size_t>(mark)].color);
  VoxelScene scene(transform, ShiftFor(transform, DiagonalOf(all.bricks, transform), options));
  AddBricks(all.bricks, colors, scene);
  scene.Seal();
  return DrawVoxels(scene, options);
}

}  // namespace

absl::StatusOr<std::vector<std::unique_ptr<AtomicFile>>> WriteDifferences(const CompareWords& words,
                                                                          const GridContent& a, const GridContent& b,
                                                                          const Cancellation& cancellation) {
  const GridTransform& transform = a.file.info.transform;
  const bool has_distances = !words.voxels_only && a.distances && b.distances;
  const MarkedVoxels all = Marking(a, b, !words.voxels_only).Mark();
  std::vector<std::unique_ptr<AtomicFile>> files;
  for (const std::string& path : words.outputs) {
    auto file = AtomicFile::Create(path, AtomicFile::Form::kUnnamed, cancellation);
    if (!file.ok()) return file.status();
    if (absl::EndsWithIgnoreCase(path, ".vdb")) {
      const GridDifference difference = DifferenceOf(all, words, has_distances);
      const auto vdb = Vdb::Load();
      if (!vdb.ok()) return vdb.status();
      const auto written = (*vdb)->WriteDifference(difference, transform, (*file)->temporary(), cancellation);
      if (!written.ok()) return (*file)->Named(written);
    } else {
      const auto png = Draw(all, transform, cancellation);
      if (!png.ok()) return png.status();
      if (auto status = (*file)->Append(*png); !status.ok()) return status;
    }
    if (auto status = (*file)->Sync(); !status.ok()) return status;
    files.push_back(*std::move(file));
  }
  return files;
}

std::string DifferenceColorsText() {
  return absl::StrJoin(kColors, ", ", [](std::string* out, const MarkColor& each) {
    absl::StrAppend(out, each.name, " ", NameOf(each.mark));
  });
}

}  // namespace latvox::client
