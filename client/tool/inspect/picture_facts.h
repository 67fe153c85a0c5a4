// Facts about files to look at.
#ifndef LATVOX_CLIENT_TOOL_INSPECT_PICTURE_FACTS_H_
#define LATVOX_CLIENT_TOOL_INSPECT_PICTURE_FACTS_H_

#include <optional>

#include "absl/status/statusor.h"
#include "client/json/json.h"
#include "client/tool/inspect/byte_source.h"

namespace latvox::client {

// Returns `width` and `height` in pixels. Errors: INVALID_ARGUMENT: not a .png, cut short.
absl::StatusOr<Json> PngFacts(FileSource& file);

// Returns `title`, `voxels`, `index_box`, `colors` and `metadata` of a page of `latvox view`. Errors: INVALID_ARGUMENT:
// another page; one whose facts take more than 1 MiB.
absl::StatusOr<Json> PageFacts(FileSource& file);

// Returns `voxels`, `triangles`, `corners`, `bounds`, `lattice`, `separability` and `digest` of a surface that latvox
// wrote as .glb; nothing for any other .glb, such as a mesh. Errors: INVALID_ARGUMENT: not a .glb, cut short.
absl::StatusOr<std::optional<Json>> SurfaceFacts(FileSource& file);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_INSPECT_PICTURE_FACTS_H_
