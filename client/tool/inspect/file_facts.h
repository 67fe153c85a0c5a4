// `latvox info` of all formats except OpenVDB's grids.
#ifndef LATVOX_CLIENT_TOOL_INSPECT_FILE_FACTS_H_
#define LATVOX_CLIENT_TOOL_INSPECT_FILE_FACTS_H_

#include <string>

#include "absl/status/statusor.h"

namespace latvox::client {

// The facts about a file.
struct FileFacts {
  std::string text;  // one line for each fact
  std::string json;  // an object with the same facts
};

// Reads the facts. The extension tells the format: a file of voxels, pixels or pictures that latvox writes, or a mesh
// that it reads; for .ply and .glb the content tells which of these it is. Memory is bounded, except that a mesh is
// read as a whole. Errors, with the path: NOT_FOUND; INVALID_ARGUMENT: another extension, naming those that can be
// read; a damaged file.
absl::StatusOr<FileFacts> ReadFileFacts(const std::string& path);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_INSPECT_FILE_FACTS_H_
