// Outputs that list crossed links: .links.csv, .links.npz.
#ifndef LATVOX_CLIENT_TOOL_OUTPUT_LINK_OUTPUT_H_
#define LATVOX_CLIENT_TOOL_OUTPUT_LINK_OUTPUT_H_

#include <memory>
#include <vector>

#include "client/tool/output/atomic_file.h"
#include "client/tool/output/output.h"

namespace latvox::client {

// Both have one row for each crossed link, see ForEachCrossedLink. Both ends of a link have a row, as far as both are
// in the set. Columns that belong to a field need it.
//   i,j,k        the voxel
//   di,dj,dk     the lattice vector to its neighbor
//   share        field links: of the link's length at which it first meets the mesh, with 9 digits
//   distance     the same in world units, with 9 digits
//   triangle     field link_triangles
//   crossings    field link_crossings
// .links.csv: memory does not grow with the links.
std::unique_ptr<Output> NewLinkTableOutput(std::unique_ptr<AtomicFile> file, const std::vector<Field>& fields);

// .links.npz: ijk, int32, L x 3; neighbor, uint8, L: the row of `neighbors`, int32, K x 3; lengths, float64, K, of
// these in the world; share, float32, triangle, crossings, int32, L; basis, float64, 3 x 3, and origin, 3. Memory: 13
// bytes for each link, and 4 for each field.
std::unique_ptr<Output> NewLinkArrayOutput(std::unique_ptr<AtomicFile> file, const std::vector<Field>& fields);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_OUTPUT_LINK_OUTPUT_H_
