#include "client/tool/output/file_metadata.h"

#include <algorithm>

namespace latvox::client {

std::string MetadatumOf(const GridFileInfo& info, absl::string_view name) {
  const auto is_it = [name](const auto& entry) { return entry.first == name; };
  const auto found = std::find_if(info.metadata.begin(), info.metadata.end(), is_it);
  return found == info.metadata.end() ? "" : found->second;
}

SortedJson RequestIn(const GridFileInfo& info) {
  return SortedJson::parse(MetadatumOf(info, "latvox_request"), nullptr, /*allow_exceptions=*/false);
}

// `up_axis` in the request names the axis of the mesh that became z.
UpAxis UpOf(const GridFileInfo& info) { return RequestIn(info).contains("up_axis") ? UpAxis::kZ : UpAxis::kY; }

bool HoldsBand(const GridContent& content) {
  return content.is_band ||
         (content.distances && MetadatumOf(content.file.info, "latvox_set") == NameOf(VoxelSet(Band())));
}

}  // namespace latvox::client
