#include "client/grid/nano_facts.h"

#include <cstddef>
#include <cstring>

#include "absl/strings/str_split.h"
#include "client/internal/voxel_size.h"

namespace latvox::client {

GridTransform NanoTransform(const nanovdb::GridData& grid) {
  GridTransform transform;
  const double* const m = grid.mMap.mMatD;  // columns are the steps
  transform.basis = {{m[0], m[3], m[6]}, {m[1], m[4], m[7]}, {m[2], m[5], m[8]}};
  for (size_t n = 0; n < 3; ++n) transform.origin[n] = grid.mMap.mVecD[n];
  transform.voxel_size = VoxelSizeOf(transform.basis);
  return transform;
}

std::vector<std::pair<std::string, std::string>> NanoMetadata(const nanovdb::GridData& grid,
                                                              const ReadNanoBytes& read) {
  const int64_t at = grid.mBlindMetadataOffset;
  const auto is_within = [&grid](int64_t place) {
    return place >= 0 && static_cast<uint64_t>(place) <= grid.mGridSize;
  };
  nanovdb::GridBlindMetaData blind;
  if (grid.mBlindMetadataCount == 0 || !is_within(at) || !read(static_cast<uint64_t>(at), &blind, sizeof(blind)))
    return {};
  if (BlindBytes(blind) > kMostNanoText || strncmp(blind.mName, kNanoBlindName, sizeof(blind.mName)) != 0) return {};
  if (!is_within(BlindOffset(blind))) return {};
  std::string text(BlindBytes(blind), '\0');
  if (!read(static_cast<uint64_t>(at) + static_cast<uint64_t>(BlindOffset(blind)), text.data(), text.size())) return {};
  std::vector<std::pair<std::string, std::string>> metadata;
  for (const absl::string_view line : absl::StrSplit(text, '\n', absl::SkipEmpty())) {
    metadata.push_back(absl::StrSplit(line, absl::MaxSplits(" = ", 1)));
  }
  return metadata;
}

}  // namespace latvox::client
