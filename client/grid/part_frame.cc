#include "client/grid/part_frame.h"

#include <openvdb/io/Archive.h>
#include <openvdb/io/GridDescriptor.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "absl/strings/str_cat.h"
#include "client/grid/grid_frame.h"
#include "client/grid/grid_reading.h"
#include "client/grid/nano_archive.h"
#include "client/grid/nano_frame.h"
#include "client/internal/printable.h"
#include "latvox/types.h"

namespace latvox::client {
namespace {

using NanoLeaf = nanovdb::NanoLeaf<bool>;
using NanoTreeData = nanovdb::NanoTree<bool>::DataType;
static_assert(sizeof(nanovdb::Mask<3>) == 8 * sizeof(uint64_t));

bool IsBand(const FrameGrid& grid) {
  return grid.type == openvdb::FloatGrid::gridType() && grid.name == NameOf(Field::kDistance);
}

// Refuses what OpenVDB's own reader does not check. Returns the first grid.
const FrameGrid& CheckFrame(const GridFrame& frame) {
  if (frame.grids.empty()) throw std::runtime_error("it holds no grid");
  const FrameGrid& grid = frame.grids.front();
  if (grid.type != openvdb::BoolGrid::gridType() && !IsBand(grid)) {
    throw std::runtime_error(absl::StrCat("its first grid is a ", Printable(grid.type)));
  }
  if (grid.transform == openvdb::math::NonlinearFrustumMap::mapType()) {
    throw std::runtime_error("its transform is not affine");
  }
  return grid;
}

// Reads the value from bytes in memory, where no length can lead OpenVDB beyond them.
openvdb::Metadata::Ptr ToMetadata(const FrameMetadata& metadata) {
  const auto size = static_cast<openvdb::Index32>(metadata.value.size());
  std::istringstream bytes(std::string(reinterpret_cast<const char*>(&size), sizeof(size)) + metadata.value);
  const openvdb::Metadata::Ptr value = openvdb::Metadata::createMetadata(metadata.type);
  value->read(bytes);
  return value;
}

// The places of the grid's sections, which io::File reads when it opens a file, and does not show.
struct Sections : openvdb::io::Archive {
  openvdb::io::GridDescriptor descriptor;
  openvdb::GridBase::Ptr grid;

  // Precondition: `first` is the result of CheckFrame.
  void Read(std::istream& in, const FrameGrid& first) {
    in.seekg(0);
    readHeader(in);
    setFormatVersion(in);
    setLibraryVersion(in);
    openvdb::MetaMap().readMeta(in);
    readGridCount(in);
    grid = descriptor.read(in);
    grid->clearMetadata();
    for (const FrameMetadata& each : first.metadata) {
      if (each.type != kDelayedLoadType) grid->insertMeta(each.name, *ToMetadata(each));
    }
    in.seekg(static_cast<std::streamoff>(first.transform_at));
    grid->readTransform(in);
  }
};

// Sets the digest. Throws std::runtime_error if the metadata has none, or if the transform is not one of latvox.
void SetDigest(PartFrame& part) {
  if (!IsAffine(part.grid->transform())) throw std::runtime_error("its transform is not affine and finite");
  const auto digest = part.grid->getMetadata<openvdb::StringMetadata>("latvox_digest");
  if (!digest) throw std::runtime_error("its metadata has no latvox_digest");
  part.digest = digest->value();
}

// Compressed leaves would have to be in memory.
void RefuseCompressed(const NanoFrameGrid& grid) {
  if (!grid.is_compressed()) return;
  throw std::runtime_error("it is compressed, which latvox never writes; latvox convert writes it anew");
}

// Sets the place of the leaves, which NanoVDB writes in the tree's order. A tree without leaves names any place.
void SetLeaves(std::istream& in, const NanoFrameGrid& grid, PartFrame& part) {
  constexpr uint64_t kTreeAt = sizeof(nanovdb::GridData);
  const uint64_t bytes = grid.header.gridSize;
  alignas(NanoTreeData) std::array<char, sizeof(NanoTreeData)> raw;
  if (bytes < kTreeAt + raw.size()) throw std::runtime_error("its grid is smaller than its header");
  in.seekg(static_cast<std::streamoff>(grid.at + kTreeAt));
  in.read(raw.data(), raw.size());
  const auto& tree = *reinterpret_cast<const NanoTreeData*>(raw.data());
  const auto first = static_cast<uint64_t>(tree.mNodeOffset[0]), leaves = uint64_t{tree.mNodeCount[0]};
  part.leaves_at = grid.at;
  if (leaves == 0) return;
  if (first > bytes - kTreeAt || leaves > (bytes - kTreeAt - first) / sizeof(NanoLeaf)) {
    throw std::runtime_error("its leaves do not lie within its grid");
  }
  part.leaves_at = grid.at + kTreeAt + first;
  part.leaves = leaves;
}

}  // namespace

PartFrame ReadVdbPart(std::istream& in, uint64_t size) {
  const GridFrame all = ReadGridFrame(in, size);
  const FrameGrid& first = CheckFrame(all);
  Sections sections;
  sections.Read(in, first);
  PartFrame part;
  part.grid = sections.grid;
  part.has_fields = IsBand(first) || all.grids.size() > 1;
  SetDigest(part);
  if (part.has_fields) return part;
  part.leaves_at = static_cast<uint64_t>(sections.descriptor.getBlockPos());
  const uint64_t bytes = static_cast<uint64_t>(sections.descriptor.getEndPos()) - part.leaves_at;
  if (bytes % kVdbLeafBytes != 0) throw std::runtime_error("its grid does not lie within it");
  part.leaves = bytes / kVdbLeafBytes;
  return part;
}

PartFrame ReadNanoPart(std::istream& in) {
  const std::vector<NanoFrameGrid> grids = ReadNanoFrame(in);
  const NanoFrameGrid& first = grids.front();
  RefuseCompressed(first);
  const nanovdb::GridData data = ReadNanoData(in, first);
  const bool is_band = data.mGridType == nanovdb::GridType::Float && first.name == NameOf(Field::kDistance);
  if (data.mGridType != nanovdb::GridType::Boolean && !is_band) {
    throw std::runtime_error("its first grid is neither one of voxels nor a band");
  }
  PartFrame part;
  part.is_nano = true;
  part.has_fields = is_band || grids.size() > 1;
  part.grid = is_band ? openvdb::GridBase::Ptr(openvdb::FloatGrid::create()) : openvdb::BoolGrid::create(false);
  DescribeNano(first.name, data, ReadNanoMetadata(in, first, data), *part.grid);
  SetDigest(part);
  if (!part.has_fields) SetLeaves(in, first, part);
  return part;
}

void ReadVdbLeaf(std::istream& in, Leaf& leaf) { leaf.readBuffers(in, /*fromHalf=*/false); }

void ReadNanoLeaf(std::istream& in, Leaf& leaf) {
  alignas(NanoLeaf) std::array<char, sizeof(NanoLeaf)> raw;
  in.read(raw.data(), raw.size());
  const auto& nano = *reinterpret_cast<const NanoLeaf*>(raw.data());
  const nanovdb::Coord& corner = nano.data()->mBBoxMin;  // of its voxels' box, or of the leaf
  leaf.setOrigin(openvdb::Coord(corner[0], corner[1], corner[2]) & ~int32_t{Leaf::DIM - 1});
  std::array<uint64_t, 8> mask, values;
  std::memcpy(mask.data(), &nano.data()->mValueMask, sizeof(mask));
  std::memcpy(values.data(), &nano.data()->mValues, sizeof(values));
  Leaf::NodeMaskType active;
  for (openvdb::Index word = 0; word < 8; ++word) active.getWord<openvdb::Index64>(word) = mask[word];
  leaf.setValueMask(active);
  std::copy(values.begin(), values.end(), leaf.buffer().data());
}

}  // namespace latvox::client
