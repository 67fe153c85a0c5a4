#include "client/grid/part_frame.h"

#include <openvdb/io/Archive.h>
#include <openvdb/io/GridDescriptor.h>

#include <stdexcept>
#include <string>
#include <vector>

#include "absl/strings/str_cat.h"
#include "client/grid/grid_frame.h"
#include "client/grid/grid_reading.h"
#include "client/grid/nano_archive.h"
#include "client/grid/nano_frame.h"
#include "client/grid/nano_tree.h"
#include "client/grid/openvdb_metadata.h"
#include "client/internal/printable.h"
#include "latvox/types.h"

namespace latvox::client {
namespace {

constexpr uint64_t kLeafBytes = 140;  // of values: see voxel_file.h

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
      if (each.type != kDelayedLoadType) grid->insertMeta(each.name, *ToOpenVdb({each.type, each.value}));
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
  const auto topology = static_cast<uint64_t>(in.tellg());
  const auto leaves = static_cast<uint64_t>(sections.descriptor.getBlockPos());
  const uint64_t bytes = static_cast<uint64_t>(sections.descriptor.getEndPos()) - leaves;
  if (bytes % kLeafBytes != 0 || topology > leaves) throw std::runtime_error("its grid does not lie within it");
  part.tree = NewVdbTree(in, topology, leaves, bytes / kLeafBytes);
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
  part.has_fields = is_band || grids.size() > 1;
  part.grid = is_band ? openvdb::GridBase::Ptr(openvdb::FloatGrid::create()) : openvdb::BoolGrid::create(false);
  DescribeNano(first.name, data, ReadNanoMetadata(in, first, data), *part.grid);
  SetDigest(part);
  if (!part.has_fields) part.tree = NewNanoTree(in, first);
  return part;
}

}  // namespace latvox::client
