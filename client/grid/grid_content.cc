#include "latvox/grid/grid_content.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "absl/strings/str_cat.h"
#include "client/grid/grid_reading.h"
#include "client/grid/grid_stream.h"
#include "client/grid/openvdb_trees.h"
#include "client/grid/tree_nodes.h"
#include "client/internal/printable.h"

namespace latvox::client {
namespace {

using openvdb::Index;

constexpr Attribute kAttributes[] = {Attribute::kPart, Attribute::kMaterial, Attribute::kColor};

// Calls visit(value) for each active voxel, in the order of a brick's bits.
template <class AnyLeaf, class Visit>
void ForEachValue(const AnyLeaf& leaf, const Visit& visit) {
  for (Index word = 0; word < 8; ++word) {
    for (uint64_t bits = leaf.getValueMask().template getWord<openvdb::Index64>(word); bits != 0; bits &= bits - 1) {
      visit(leaf.getValue(word * 64 + static_cast<Index>(std::countr_zero(bits))));
    }
  }
}

Band BandOf(const openvdb::GridBase& grid, const std::vector<float>& distances) {
  Band band;
  const auto is_signed = grid.getMetadata<openvdb::BoolMetadata>("latvox_band_signed");
  const auto width = grid.getMetadata<openvdb::DoubleMetadata>("latvox_band_width");
  for (const float distance : distances) {
    band.width = std::max(band.width, std::abs(double{distance}));
    band.is_signed |= distance < 0;
  }
  if (is_signed) band.is_signed = is_signed->value();
  if (width) band.width = width->value();
  return band;
}

absl::StatusOr<GridContent> ReadBand(openvdb::FloatGrid& grid, const std::string& path, bool values) {
  if (auto status = CheckTransform(grid, path); !status.ok()) return status;
  const auto leaves = SortedLeaves(grid.tree(), path);
  if (!leaves.ok()) return leaves.status();
  GridContent content{{Describe(grid), {}}};
  content.file.bricks.reserve(leaves->size());
  if (values) content.distances.reserve(content.file.info.active_voxels);
  for (const auto* leaf : *leaves) {
    content.file.bricks.push_back(ToBrick(*leaf));
    if (values) ForEachValue(*leaf, [&](float distance) { content.distances.push_back(distance); });
  }
  if (!std::all_of(content.distances.begin(), content.distances.end(), [](float d) { return std::isfinite(d); })) {
    return absl::InvalidArgumentError(absl::StrCat(path, ": has distances that are not finite"));
  }
  content.band = BandOf(grid, content.distances);
  return content;
}

// False where latvox writes no such value.
bool ToNumber(int32_t value, uint32_t& number) {
  number = static_cast<uint32_t>(value);
  return true;
}
bool ToNumber(const openvdb::Vec3s& color, uint32_t& number) {
  number = 0;
  for (int m = 0; m < 3; ++m) {
    if (!(color[m] >= 0 && color[m] <= 1)) return false;
    number = number << 8 | static_cast<uint32_t>(std::lround(color[m] * 255));
  }
  return true;
}

// The numbers of attribute n.
template <class Grid>
absl::Status ReadNumbers(openvdb::GridBase& base, const std::string& path, size_t n, GridContent& content) {
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
  uint32_t* number = content.numbers.data() + n;
  bool good = true;
  for (const auto* leaf : *leaves) {
    ForEachValue(*leaf, [&](const auto& value) {
      good &= ToNumber(value, *number);
      number += content.attributes.size();
    });
  }
  return good ? absl::OkStatus() : wrong("has values that are no colors from 0 to 1");
}

absl::StatusOr<GridContent> ReadSet(GridArchive& archive, const std::string& path, bool values) {
  auto set = ReadVoxels(archive, path);
  if (!set.ok()) return set.status();
  GridContent content{*std::move(set)};
  if (!values || content.file.info.name != "voxels") return content;
  for (const Attribute attribute : kAttributes) {
    if (archive.HasGrid(NameOf(attribute))) content.attributes.push_back(attribute);
  }
  content.numbers.resize(content.file.info.active_voxels * content.attributes.size());
  for (size_t n = 0; n < content.attributes.size(); ++n) {
    const openvdb::GridBase::Ptr grid = archive.ReadGrid(NameOf(content.attributes[n]));
    const absl::Status status = content.attributes[n] == Attribute::kColor
                                    ? ReadNumbers<openvdb::Vec3SGrid>(*grid, path, n, content)
                                    : ReadNumbers<openvdb::Int32Grid>(*grid, path, n, content);
    if (!status.ok()) return status;
  }
  return content;
}

}  // namespace

absl::StatusOr<GridContent> ReadGridContent(std::istream& in, const std::string& path, bool values) {
  return WithArchive(in, path, [&](GridArchive& archive) -> absl::StatusOr<GridContent> {
    if (!archive.empty() && archive.FirstName() == "distance" && !archive.HasGrid("voxels")) {
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
