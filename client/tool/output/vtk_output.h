// Voxels for VTK, and programs on it such as ParaView and PyVista.
#ifndef LATVOX_CLIENT_TOOL_OUTPUT_VTK_OUTPUT_H_
#define LATVOX_CLIENT_TOOL_OUTPUT_VTK_OUTPUT_H_

#include <memory>
#include <vector>

#include "client/tool/output/atomic_file.h"
#include "client/tool/output/box_shape.h"
#include "client/tool/output/output.h"

namespace latvox::client {

// The error of .vti for other lattices.
inline constexpr char kBoxesOnly[] = "the format holds boxes along the axes only, those of --lattice cartesian";

// .vti: an image whose cells are the lattice points of a box. So the center of a cell is the position of its voxel, and
// a filter such as Threshold shows the voxels as they are. Cell data: `data`, then the fields, those of links with a
// component for each neighbor; see DenseFields. Without a box, it has one empty cell at lattice point 0.
// Memory: 88 bytes for each brick, and the fields. Errors, before the first voxel: INVALID_ARGUMENT for a basis that is
// not IsAlongAxes; RESOURCE_EXHAUSTED for an array of more than 2^32 bytes.
std::unique_ptr<Output> NewVtiOutput(std::unique_ptr<AtomicFile> file, const std::vector<Field>& fields,
                                     const BoxShape& shape);

enum class VtuForm { kPoints, kCells };

// .vtu: a cell for each voxel, in the order of the stream, on any lattice. Data: `ijk`, then the fields; those of links
// have a component for each neighbor.
//   kPoints   the cell is a point, with point data
//   kCells    the cell is the voxel's Voronoi cell, with cell data: a hexahedron on Cartesian lattices, otherwise a
//             polyhedron. Cells share no points. Before compression, a voxel takes 0.3 KB as a hexahedron, and 1.5 KB
//             on BCC.
// Memory: 80 bytes for each brick, and the fields.
std::unique_ptr<Output> NewVtuOutput(std::unique_ptr<AtomicFile> file, const std::vector<Field>& fields, VtuForm form);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_OUTPUT_VTK_OUTPUT_H_
