// The digest that identifies a job across runs.
#ifndef LATVOX_CLIENT_TOOL_CLI_JOB_DIGEST_H_
#define LATVOX_CLIENT_TOOL_CLI_JOB_DIGEST_H_

#include <string>

#include "absl/status/statusor.h"
#include "client/tool/cli/job_line.h"

namespace latvox::client {

// Returns a SHA-256 (64 hexadecimal digits) of the aligned request, the names of the outputs and the mesh. The mesh
// counts by the bytes of its file, or by its triangles if the file may refer to others (.glb, .gltf). The spelling of
// the job, the path of the mesh and the encoding of voxels do not count.
// Reads the whole mesh. Errors: those of reading it.
absl::StatusOr<std::string> JobDigest(const Job& job);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_CLI_JOB_DIGEST_H_
