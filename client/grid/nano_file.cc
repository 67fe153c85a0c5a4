#include "client/grid/nano_file.h"

#include <cstring>
#include <ostream>
#include <string>
#include <utility>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "client/grid/nano_facts.h"
#include "client/grid/new_file.h"
#include "client/grid/openvdb_metadata.h"
#if LATVOX_NANOVDB_OF_OPENVDB_12
#define NANOVDB_USE_OPENVDB
#include <nanovdb/tools/CreateNanoGrid.h>
#include <nanovdb/tools/GridChecksum.h>
#else
#include <nanovdb/util/GridChecksum.h>
#include <nanovdb/util/OpenToNanoVDB.h>
#endif

namespace latvox::client {
namespace {

// Returns our metadata as `latvox info` shows them.
std::string TextOf(const openvdb::MetaMap& metadata) {
  std::string text;
  for (auto meta = metadata.beginMeta(); meta != metadata.endMeta(); ++meta) {
    if (absl::StartsWith(meta->first, "latvox_"))
      absl::StrAppend(&text, meta->first, " = ", MetadataText(*meta->second), "\n");
  }
  return text;
}

#if LATVOX_NANOVDB_OF_OPENVDB_12
template <class Grid>
nanovdb::GridHandle<> ConvertedAs(const Grid& grid) {
  return nanovdb::tools::createNanoGrid(grid);
}
void UpdateChecksum(nanovdb::GridHandle<>& handle) {
  nanovdb::tools::updateChecksum(reinterpret_cast<nanovdb::GridData*>(handle.data()));
}
#else
template <class Grid>
nanovdb::GridHandle<> ConvertedAs(const Grid& grid) {
  return nanovdb::openToNanoVDB(grid);
}
void UpdateChecksum(nanovdb::GridHandle<>& handle) {
  const auto update = [](auto* grid) {  // null if the grid is of another type
    if (grid != nullptr) nanovdb::updateChecksum(*grid);
  };
  update(handle.grid<bool>());
  update(handle.grid<float>());
  update(handle.grid<int32_t>());
  update(handle.grid<nanovdb::Vec3f>());
}
#endif

nanovdb::GridHandle<> Converted(const openvdb::GridBase& grid) {
  using Grids = openvdb::TypeList<openvdb::BoolGrid, openvdb::FloatGrid, openvdb::Int32Grid, openvdb::Vec3SGrid>;
  nanovdb::GridHandle<> handle;
  grid.apply<Grids>([&handle](const auto& typed) { handle = ConvertedAs(typed); });
  return handle;
}

// NanoVDB's converter drops metadata, but its format has blind data, after the nodes, for other content.
nanovdb::GridHandle<> WithText(const nanovdb::GridHandle<>& plain, const std::string& text) {
  constexpr uint64_t kAlignment = NANOVDB_DATA_ALIGNMENT;
  const uint64_t bytes = (text.size() / kAlignment + 1) * kAlignment;  // at least one 0 ends the text
  const uint64_t plain_size = plain.buffer().bufferSize();
  const uint64_t size = plain_size + sizeof(nanovdb::GridBlindMetaData) + bytes;
  auto buffer = nanovdb::HostBuffer::create(size);
  char* const begin = reinterpret_cast<char*>(buffer.data());
  std::memcpy(begin, plain.data(), plain_size);
  std::memset(begin + plain_size, 0, size - plain_size);
  auto* const blind = reinterpret_cast<nanovdb::GridBlindMetaData*>(begin + plain_size);
  auto* const data = reinterpret_cast<nanovdb::GridData*>(begin);
  data->mGridSize = size;
  data->mBlindMetadataOffset = static_cast<int64_t>(plain_size);
  data->mBlindMetadataCount = 1;
  blind->setBlindData(blind + 1);
  SetBlindBytes(*blind, text.size());
  blind->mSemantic = nanovdb::GridBlindDataSemantic::Unknown;
  blind->mDataClass = nanovdb::GridBlindDataClass::Unknown;
  blind->mDataType = nanovdb::GridType::Unknown;
  std::memcpy(blind->mName, kNanoBlindName, sizeof(kNanoBlindName));
  std::memcpy(begin + plain_size + sizeof(*blind), text.data(), text.size());
  nanovdb::GridHandle<> handle(std::move(buffer));
  UpdateChecksum(handle);
  return handle;
}

}  // namespace

absl::Status WriteNanoFile(const openvdb::GridCPtrVec& grids, const std::string& path, const LateGrids& late,
                           const Cancellation& cancellation) {
  // NanoVDB does not check whether its stream took everything; this one throws.
  return WriteNewFile(path, cancellation, [&](std::ostream& file) {
    ForEachGrid(grids, late, [&](const openvdb::GridBase::ConstPtr& grid) {
      if (cancellation.cancelled()) file.setstate(std::ios::badbit);
      nanovdb::io::writeGrid(file, WithText(Converted(*grid), TextOf(*grid)), nanovdb::io::Codec::NONE);
    });
  });
}

}  // namespace latvox::client
