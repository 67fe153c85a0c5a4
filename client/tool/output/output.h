// Files of voxels.
#ifndef LATVOX_CLIENT_TOOL_OUTPUT_OUTPUT_H_
#define LATVOX_CLIENT_TOOL_OUTPUT_OUTPUT_H_

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "client/tool/output/box_shape.h"
#include "latvox/cancellation.h"
#include "latvox/grid/carried_names.h"
#include "latvox/grid/grid_content.h"
#include "latvox/mesh_files/up_axis.h"
#include "latvox/types.h"
#include "latvox/warning.h"

namespace latvox::client {

// Receives the data of a call in order: Begin, any number of Add, Finish, Commit. Only Commit changes the target file.
// Without it nothing is left behind. Not thread-safe.
// Errors: FAILED_PRECONDITION, naming the file and the message of the system; RESOURCE_EXHAUSTED (memory); CANCELLED.
class Output {
 public:
  virtual ~Output() = default;

  // Gives the numbers of fields their names. Call it before Begin. Formats without names ignore it.
  virtual void SetNames(const CarriedNames&) {}

  virtual absl::Status Begin(const Accepted& accepted) = 0;
  virtual absl::Status Add(const BrickBatch& batch) = 0;
  // Returns what the file will lack although its format holds the fields. Call it between the last Add and Finish.
  virtual std::vector<Warning> Warnings() const { return {}; }
  virtual absl::Status Finish(const Summary& summary) = 0;  // afterward everything is on the disk
  virtual absl::Status Commit() = 0;
};

// Returns a page that shows the content of a .vdb file under a title; see client/tool/view/page.h.
using MakePage =
    std::function<absl::StatusOr<std::string>(const GridContent& content, const std::string& title, UpAxis up)>;

// Names and values of metadata, as text.
using MetadataPairs = std::vector<std::pair<std::string, std::string>>;

// Options of an output besides its extension.
struct OutputOptions {
  bool dense_npy = false;
  std::optional<std::vector<Field>> array = std::nullopt;  // fields of an output that IsLimited; absent: all
  BoxShape shape = {};                                     // of dense arrays
  UpAxis picture_up = UpAxis::kY;                          // axis of the world that points up in a .png or .html
  MeshNote note = {};                                      // of the mesh, for the metadata of grids
  MakePage make_page = nullptr;                            // of a .html, which needs it
  std::optional<MetadataPairs> metadata = std::nullopt;    // of grids, in place of request, note and summary
  bool is_one_file = false;                                // the file is sent on, so another could not go with it
  Cancellation cancellation = {};                          // ends the writing within a moment
};

// What voxels ask of a format.
struct ToHold {
  std::vector<Field> fields;
  std::optional<Basis> basis;  // of the lattice, at any scale; absent: it is not known yet
};

// Why a file cannot hold voxels: because of their lattice or of their fields.
struct NotHeld {
  bool is_lattice;
  std::string text;
  std::string able;  // the formats that can, with spaces between them
};

// Returns the extension, with the dot, in lower case: also the double ones, such as ".nii.gz" and ".links.csv".
std::string ExtensionOf(const std::string& path);

// Returns the extensions that OpenOutput supports, with the dot.
const std::vector<std::string>& OutputExtensions();

// Returns the extensions of the formats that have OutputOptions::shape; a .npy only if it is dense.
const std::vector<std::string>& ShapedExtensions();

// Returns the extensions of the formats that hold some fields alone, or some together; a .npy only if it is dense.
const std::vector<std::string>& LimitedExtensions();

// Returns the formats that are one file, and so can be sent to standard output: the extension without the dot, and what
// it is.
std::vector<std::pair<std::string, std::string>> StreamedFormats();

// Returns whether the path has one of these extensions.
bool HasExtension(const std::string& path, const std::vector<std::string>& extensions);

// Returns whether the file's format cannot hold all fields together. Then OutputOptions::array selects its fields.
bool IsLimited(const std::string& path, const OutputOptions& options);

// Returns the names with commas between them: "part,distance".
std::string JoinNames(const std::vector<Field>& fields);

// Returns what the request's voxels ask of a format.
ToHold ToHoldOf(const VoxelizeRequest& request);

// Returns the extensions of the formats that hold or show such voxels with these options. Without a basis, they hold
// them on each lattice.
std::vector<std::string> AbleFormats(const ToHold& voxels, const OutputOptions& options);

// Returns nothing if the output can hold or show such voxels, with those of their fields that it gets. Otherwise the
// text says what it cannot hold, and which formats can: "cannot hold part,distance; .vdb .csv can". Without a basis,
// only fields count. Precondition: the path has one of OutputExtensions.
std::optional<NotHeld> WhyNotHeld(const std::string& path, const ToHold& voxels, const OutputOptions& options);

// Returns the warning NO_TRANSFORM if a .npy is among the paths, and none of the files tells where in the world the
// voxels are. Otherwise returns nothing.
std::optional<Warning> WarningOfPlace(const std::vector<std::string>& paths);

// Opens the output for the path's extension:
//   .vdb   OpenVDB, see latvox/grid/voxel_grid.h
//   .nvdb  NanoVDB, the same grid, its metadata as text
//   .csv   header i,j,k,x,y,z; lattice coordinates, world position with 17 significant digits
//   .npy   int32 array of shape (voxels, 3): lattice coordinates; or dense, see client/tool/output/dense_output.h
//   .npz   dense, with its place in the world: see client/tool/output/npz_output.h
//   .ply   points, binary little-endian: double x, y, z, int i, j, k
//   .png   picture
//   .html  page, as that of the .vdb
//   .glb   surface, see client/tool/output/surface_output.h
//   .binvox  a box of cubes, see client/tool/output/box_output.h
//   .vox   models of cubes, see client/tool/output/vox_output.h
//   .h5    arrays that grow, see client/tool/output/hdf5_output.h
//   .links.csv, .links.npz   crossed links: see client/tool/output/link_output.h
//   .vti, .vtu, .cells.vtu   cells of a box, points, and Voronoi cells: see client/tool/output/vtk_output.h
//   .nrrd, .mha, .mhd, .nii, .nii.gz   images in space, see client/tool/output/image_output.h
// WhyNotHeld tells which fields and lattices do not fit.
// Columns are those of client/tool/output/field_columns.h. label_fractions is an array, a grid, a column or a member
// for each label, with FractionName, and in a .h5 an array with a column for each:
//   .vdb, .nvdb   one more grid for each, see latvox/grid/field_grids.h; a band with distances alone, see
//          distance_grid.h
//   .csv   further columns, floats with 9 significant digits; part_name, material_name, if there are names
//   .npy   structured array: ijk, three int32, and one member for each field, with its name; dense: one field, whose
//          components are a fourth axis
//   .npz   one more array for each, with its name; for fields of links, of the voxels alone, with ijk and neighbors
//   .ply   further properties
//   .png   picture of voxels in their colors, otherwise by material, otherwise by part; of a band with distances, the
//          voxels nearest to the surface, see client/tool/output/picture_scene.h
//   .vox   the color, or a color for each material or part, as a palette; one field
//   .glb   the same as colors of the surface's vertices
//   .vti, .vtu   arrays; those of links have a component for each neighbor
//   images   components of each element, if the fields have one type of numbers; NIfTI one field
// Voxels come in the order of the stream, those of a brick in lexicographic order. Memory does not grow with the
// voxels, except for .vdb, .nvdb, .html, .glb, .binvox, .vox, .vtu, .links.npz and dense arrays: .npy, .npz, .vti
// and images.
// Errors: INVALID_ARGUMENT: the extension; fields or lattice, see WhyNotHeld; FAILED_PRECONDITION: the file cannot be
// created; of .vdb with fields, .nvdb and .html, those of Vdb::Prepare, and later those of Vdb::Load.
absl::StatusOr<std::unique_ptr<Output>> OpenOutput(const std::string& path, const VoxelizeRequest& request = {},
                                                   const OutputOptions& options = {});

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_OUTPUT_OUTPUT_H_
