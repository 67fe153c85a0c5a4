#include "latvox/grid/grid_content.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <utility>

#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_split.h"
#include "client/grid/grid_reading.h"
#include "client/grid/grid_stream.h"
#include "client/grid/link_grids.h"
#include "client/grid/open_file.h"
#include "client/grid/openvdb_trees.h"
#include "client/grid/tree_nodes.h"
#include "client/internal/printable.h"

namespace latvox::client {
namespace {

using openvdb::Index;

// Calls visit(value) for each active voxel, in the order of a brick's bits.
template <class AnyLeaf, class Visit>
void ForEachValue(const AnyLeaf& leaf, const Visit& visit) {
  for (Index word = 0; word < 8; ++word) {
    for (uint64_t bits = leaf.getValueMask().template getWord<openvdb::Index64>(word); bits != 0; bits &= bits - 1) {
      visit(leaf.getValue(word * 64 + static_cast<Index>(std::countr_zero(bits))));
    }
  }
}

template <class T>
void Append(const T& numbers, std::vector<std::byte>& bytes) {
  const auto* const first = reinterpret_cast<const std::byte*>(&numbers);
  bytes.insert(bytes.end(), first, first + sizeof(T));
}

// Appends the components of a field. False where latvox writes no such value.
bool AppendField(Field field, int32_t number, std::vector<std::byte>& bytes) {
  if (FactsOf(field).type == NumberType::kUint16) {
    Append(static_cast<uint16_t>(number), bytes);
    return number >= 0 && number <= std::numeric_limits<uint16_t>::max();
  }
  Append(number, bytes);
  return number >= 0;
}
bool AppendField(Field, float number, std::vector<std::byte>& bytes) {
  Append(number, bytes);
  return std::isfinite(number);
}
bool AppendField(Field field, const openvdb::Vec3s& vector, std::vector<std::byte>& bytes) {
  bool good = true;
  for (int m = 0; m < static_cast<int>(FactsOf(field).components); ++m) {
    const bool is_color = field == Field::kColor;
    good &= std::isfinite(vector[m]) && (!is_color || (vector[m] >= 0 && vector[m] <= 1));
    if (is_color) {
      Append(static_cast<uint8_t>(good ? std::lround(vector[m] * 255) : 0), bytes);
    } else {
      Append(vector[m], bytes);
    }
  }
  return good;
}

// Reads the values of a field from the leaves of its grid. False: some are no values of this field.
template <class Leaves>
bool ReadValues(const Leaves& leaves, uint64_t voxels, FieldValues& values) {
  values.bytes.reserve(voxels * values.bytes_of_voxel());
  bool good = true;
  for (const auto* leaf : leaves) {
    ForEachValue(*leaf, [&](const auto& value) { good &= AppendField(values.field, value, values.bytes); });
  }
  return good;
}

void SetRange(const openvdb::GridBase& grid, GridContent& content) {
  const FieldValues* const distances = FindField(content.fields, Field::kDistance);
  if (distances == nullptr) return;
  DistanceRange& range = content.distances.emplace();
  for (const float distance : distances->As<float>()) {
    range.most = std::max(range.most, std::abs(double{distance}));
    range.is_signed |= distance < 0;
  }
  const auto is_signed = grid.getMetadata<openvdb::BoolMetadata>("latvox_signed_distance");
  const auto width = grid.getMetadata<openvdb::DoubleMetadata>("latvox_band_width");
  if (is_signed) range.is_signed = is_signed->value();
  if (width) range.most = width->value();
}

absl::StatusOr<GridContent> ReadBand(openvdb::FloatGrid& grid, const std::string& path, bool values) {
  if (auto status = CheckTransform(grid, path); !status.ok()) return status;
  const auto leaves = SortedLeaves(grid.tree(), path);
  if (!leaves.ok()) return leaves.status();
  GridContent content{.file = {Describe(grid), {}}, .is_band = true};
  content.file.bricks.reserve(leaves->size());
  for (const auto* leaf : *leaves) content.file.bricks.push_back(ToBrick(*leaf));
  if (!values) return content;
  content.fields.push_back({Field::kDistance, {}});
  if (!ReadValues(*leaves, content.file.info.active_voxels, content.fields.back())) {
    return absl::InvalidArgumentError(absl::StrCat(path, ": has distances that are not finite"));
  }
  SetRange(grid, content);
  return content;
}

template <class Grid>
absl::Status ReadField(openvdb::GridBase& base, const std::string& path, const GridContent& content,
                       FieldValues& values) {
  const auto wrong = [&](const auto&... what) {
    return absl::InvalidArgumentError(absl::StrCat(path, ": the grid \"", Printable(base.getName()), "\" ", what...));
  };
  if (base.type() != Grid::gridType()) return wrong("is a ", base.type(), ", not a ", Grid::gridType());
  const auto leaves = SortedLeaves(static_cast<Grid&>(base).tree(), path);
  if (!leaves.ok()) return leaves.status();
  const std::vector<Brick>& bricks = content.file.bricks;
  const auto same = [](const auto* leaf, const Brick& brick) {
    const Brick found = ToBrick(*leaf);
    return found.brick_ijk == brick.brick_ijk && found.mask == brick.mask;
  };
  if (!std::equal(leaves->begin(), leaves->end(), bricks.begin(), bricks.end(), same)) {
    return wrong("has other voxels than the grid \"", content.file.info.name, "\"");
  }
  if (ReadValues(*leaves, content.file.info.active_voxels, values)) return absl::OkStatus();
  return wrong("has values that are no ", NameOf(values.field));
}

absl::Status ReadField(openvdb::GridBase& grid, const std::string& path, const GridContent& content,
                       FieldValues& values) {
  const FieldFacts& facts = FactsOf(values.field);
  if (facts.components > 1) return ReadField<openvdb::Vec3SGrid>(grid, path, content, values);
  if (facts.type == NumberType::kFloat32) return ReadField<openvdb::FloatGrid>(grid, path, content, values);
  return ReadField<openvdb::Int32Grid>(grid, path, content, values);
}

// Reads the labels of fractions from the metadata.
absl::StatusOr<std::vector<uint32_t>> LabelsOf(const GridFileInfo& info, const std::string& path) {
  constexpr char kName[] = "latvox_fraction_labels";
  std::vector<uint32_t> labels;
  for (const auto& [name, text] : info.metadata) {
    if (name != kName) continue;
    for (const absl::string_view word : absl::StrSplit(text, ',')) {
      uint32_t label = 0;
      if (!absl::SimpleAtoi(word, &label) || labels.size() == kMostFractionLabels) {
        return absl::InvalidArgumentError(absl::StrCat(path, ": ", kName, " \"", Printable(text),
                                                       "\" is no list of 1 to ", kMostFractionLabels, " labels"));
      }
      labels.push_back(label);
    }
  }
  return labels;
}

// Reads the fractions of labels, a grid for each. Without such grids, there are none.
absl::Status ReadFractions(GridArchive& archive, const std::string& path, GridContent& content) {
  const auto labels = LabelsOf(content.file.info, path);
  if (!labels.ok() || labels->empty()) return labels.status();
  const auto has_grid = [&](uint32_t label) { return archive.HasGrid(FractionName(label)); };
  if (!has_grid(labels->front())) return absl::OkStatus();
  const auto lacking = std::ranges::find_if_not(*labels, has_grid);
  if (lacking != labels->end()) {
    return absl::InvalidArgumentError(absl::StrCat(path, ": lacks the grid \"", FractionName(*lacking), "\""));
  }
  FieldValues fractions{Field::kLabelFractions, {}, 0, *labels};
  fractions.bytes.resize(content.file.info.active_voxels * fractions.bytes_of_voxel());
  auto* const numbers = reinterpret_cast<uint16_t*>(fractions.bytes.data());
  for (size_t n = 0; n < labels->size(); ++n) {
    FieldValues of_label{Field::kFraction, {}};
    const auto grid = archive.ReadGrid(FractionName((*labels)[n]));
    if (auto status = ReadField(*grid, path, content, of_label); !status.ok()) return status;
    size_t voxel = 0;
    for (const uint16_t number : of_label.As<uint16_t>()) numbers[voxel++ * labels->size() + n] = number;
  }
  content.fields.push_back(std::move(fractions));
  return absl::OkStatus();
}

absl::StatusOr<GridContent> ReadSet(GridArchive& archive, const std::string& path, bool values) {
  auto set = ReadVoxels(archive, path);
  if (!set.ok()) return set.status();
  GridContent content{.file = *std::move(set)};
  if (!values || content.file.info.name != "voxels") return content;
  auto neighbors = ReadNeighbors(archive, path);
  if (!neighbors.ok()) return neighbors.status();
  content.neighbors = *std::move(neighbors);
  for (const FieldFacts& row : kFields) {
    if (row.field == Field::kLinks) {
      if (auto status = ReadLinks(archive, path, content); !status.ok()) return status;
    }
    if (row.is_of_links() || row.is_of_labels() || !archive.HasGrid(row.name)) continue;
    FieldValues field{row.field, {}};
    const openvdb::GridBase::Ptr grid = archive.ReadGrid(row.name);
    if (auto status = ReadField(*grid, path, content, field); !status.ok()) return status;
    content.fields.push_back(std::move(field));
    if (row.field == Field::kDistance) SetRange(*grid, content);
  }
  static_assert(kFields.back().is_of_labels() && FactsOf(Field::kLinkCrossings).is_of_links() &&
                    static_cast<int>(Field::kLinkCrossings) == static_cast<int>(Field::kLinks) + 2,
                "fields keep the order of kFields");
  if (auto status = ReadFractions(archive, path, content); !status.ok()) return status;
  return content;
}

}  // namespace

absl::StatusOr<GridContent> ReadGridContent(std::istream& in, const std::string& path, bool values) {
  return WithArchive(in, path, [&](GridArchive& archive) -> absl::StatusOr<GridContent> {
    if (archive.IsBand()) {
      const auto grid = openvdb::gridPtrCast<openvdb::FloatGrid>(archive.ReadGrid("distance"));
      if (grid) return ReadBand(*grid, path, values);
    }
    return ReadSet(archive, path, values);
  });
}

absl::StatusOr<GridContent> ReadGridContent(const std::string& path, bool values) {
  auto file = OpenGridFile(path);
  if (!file.ok()) return file.status();
  return ReadGridContent(*file, path, values);
}

}  // namespace latvox::client
