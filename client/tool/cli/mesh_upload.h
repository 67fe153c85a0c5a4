// The mesh of a job, in the form in which it goes to the server.
#ifndef LATVOX_CLIENT_TOOL_CLI_MESH_UPLOAD_H_
#define LATVOX_CLIENT_TOOL_CLI_MESH_UPLOAD_H_

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "client/mesh_files/mesh_source.h"
#include "client/mesh_files/weld_report.h"
#include "client/tool/cli/session.h"
#include "client/tool/cli/voxelize_options.h"
#include "client/tool/texture/base_color_sampler.h"
#include "latvox/client.h"
#include "latvox/grid/carried_names.h"
#include "latvox/types.h"
#include "latvox/warning.h"

namespace latvox::client {

struct MeshUpload {
  std::string bytes;  // a Draco stream, or the arrays of `raw`
  std::optional<RawMeshLayout> raw = std::nullopt;
  uint64_t skipped = 0;  // elements of the file that have no surface
  std::optional<WeldReport> weld = std::nullopt;
  CarriedNames names = {};
  std::shared_ptr<BaseColorSampler> base_colors = nullptr;  // if the tool colors voxels, or leaves some out
  std::vector<Warning> warnings = {};
  double read_ms = 0, encode_ms = 0;
};

// Returns the mesh of a job, on a thread of its own: it must own everything that it uses.
using MeshReader = std::function<absl::StatusOr<MeshOrDraco>()>;

// Reads the mesh and brings it into the form of --upload. The form "auto" is:
//   Draco    if --quantization asks for bits, because arrays are never rounded
//   arrays   if the mesh needs doubles, or if no network is in between and they take at most 1 GiB
//   Draco    otherwise, because a network is slower than its encoder
// A .drc file is sent as it is. Errors: those of `read_mesh`; INVALID_ARGUMENT: it is a .drc file, and arrays are
// asked for. Warnings: POSITIONS_ROUNDED, if Draco is asked for.
absl::StatusOr<MeshUpload> PrepareUpload(const VoxelizeOptions& options, const MeshReader& read_mesh, bool has_network,
                                         const CallOptions& call,
                                         const std::function<void(const std::string& stage)>& on_stage);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_CLI_MESH_UPLOAD_H_
