// Where voxels go: one file of one format.
#ifndef LATVOX_CLIENT_TOOL_OUTPUT_OUTPUT_H_
#define LATVOX_CLIENT_TOOL_OUTPUT_OUTPUT_H_

#include <memory>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "client/mesh/up_axis.h"
#include "latvox/types.h"

namespace latvox::client {

// Receives what a call delivers, in the same order: Begin, any number of Add, Finish, Commit. The target file changes
// in Commit only; without it nothing is left behind. Not thread-safe. Errors: FAILED_PRECONDITION, naming
// the file and what the system says; RESOURCE_EXHAUSTED (memory).
class Output {
 public:
  virtual ~Output() = default;
  virtual absl::Status Begin(const Accepted& accepted) = 0;
  virtual absl::Status Add(const BrickBatch& batch) = 0;
  virtual absl::Status Finish(const Summary& summary) = 0;  // everything is on the disk afterwards
  virtual absl::Status Commit() = 0;
};

// What an extension alone does not say.
struct OutputOptions {
  bool dense_npy = false;
  UpAxis picture_up = UpAxis::kY;  // which axis of the world a .png shows upwards
  MeshNote note = {};              // of the mesh, for the metadata of grids
};

// Extensions that OpenOutput knows, with the dot.
const std::vector<std::string>& OutputExtensions();

// Those of them that a band, or voxels with attributes, can be written to: they hold the distances or attributes, but
// for pictures.
std::vector<std::string> DistanceExtensions();
std::vector<std::string> AttributeExtensions(const std::vector<Attribute>& attributes);

// Whether the path's is one of these.
bool HasExtension(const std::string& path, const std::vector<std::string>& extensions);

// Opens the output for the path's extension:
//   .vdb   OpenVDB, see latvox/grid/voxel_grid.h
//   .nvdb  NanoVDB, the same grid, its metadata as text
//   .csv   header i,j,k,x,y,z; lattice coordinates, world position with 17 significant digits
//   .npy   int32 array of shape (voxels, 3): lattice coordinates; or dense, see client/tool/output/dense_output.h
//   .ply   points, binary little-endian: double x, y, z, int i, j, k
//   .png   picture
//   .glb   surface, see client/tool/output/surface_output.h
//   .binvox, .vox   boxes of cubes, see client/tool/output/box_output.h
// Of a request for a band, one of DistanceExtensions is needed:
//   .vdb   a grid of distances, see latvox/grid/distance_grid.h
//   .csv   a column more, distance, with 9 significant digits
//   .npy   structured array of shape (voxels,): fields ijk, three int32, and distance, float32
//   .ply   a property more, float distance
//   .png   picture of the voxels that are nearest to the surface, see client/tool/output/picture_scene.h
// Of a request for attributes, one of AttributeExtensions:
//   .vdb   a further grid each, see latvox/grid/attribute_grids.h
//   .csv   columns part, material; red, green, blue, 0 to 255
//   .npy   structured array: fields part and material, int32; color, three uint8
//   .ply   properties int part, material; uchar red, green, blue
//   .png   picture of voxels in their colors; without any, in one for each material, or else part
//   .glb   colors of the surface's vertices: color alone
// Voxels come in the order of the stream, those of a brick in lexicographic order. Memory does not grow with the
// voxels, .vdb, .nvdb, dense .npy, .glb, .binvox and .vox aside. Errors: INVALID_ARGUMENT (extension);
// FAILED_PRECONDITION (the file cannot be created).
absl::StatusOr<std::unique_ptr<Output>> OpenOutput(const std::string& path, const VoxelizeRequest& request = {},
                                                   const OutputOptions& options = {});

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_OUTPUT_OUTPUT_H_
