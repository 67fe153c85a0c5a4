// What tells whether a job is the one that was done before.
#ifndef LATVOX_CLIENT_TOOL_CLI_JOB_DIGEST_H_
#define LATVOX_CLIENT_TOOL_CLI_JOB_DIGEST_H_

#include <string>

#include "absl/status/statusor.h"
#include "client/tool/cli/job_line.h"

namespace latvox::client {

// SHA-256 (64 hexadecimal digits) of what is asked for, once aligned, the outputs' names and the mesh: of the file's
// bytes, or of the triangles where a file may refer to others (.glb, .gltf). How the job was written, where the mesh
// lies and how voxels travel do not matter. Reads the whole mesh. Errors: those of reading it.
absl::StatusOr<std::string> JobDigest(const Job& job);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_CLI_JOB_DIGEST_H_
