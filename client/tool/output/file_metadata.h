// Facts from a grid's metadata.
#ifndef LATVOX_CLIENT_TOOL_OUTPUT_FILE_METADATA_H_
#define LATVOX_CLIENT_TOOL_OUTPUT_FILE_METADATA_H_

#include <string>

#include "absl/strings/string_view.h"
#include "client/json/json.h"
#include "latvox/grid/grid_content.h"
#include "latvox/grid/voxel_grid.h"
#include "latvox/mesh_files/up_axis.h"

namespace latvox::client {

// Returns the text of this name, or an empty one.
std::string MetadatumOf(const GridFileInfo& info, absl::string_view name);

// Returns the request in the file, or a discarded value, which contains nothing.
SortedJson RequestIn(const GridFileInfo& info);

// Returns the axis of the world that points up: z if --up-axis turned the mesh, otherwise y. Files of other programs do
// not tell.
UpAxis UpOf(const GridFileInfo& info);

// Returns whether the voxels are a band with distances, with or without other fields.
bool HoldsBand(const GridContent& content);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_OUTPUT_FILE_METADATA_H_
