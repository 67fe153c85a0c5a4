// Meshes from arrays of numpy.
#ifndef LATVOX_CLIENT_PYTHON_MESH_ARRAYS_H_
#define LATVOX_CLIENT_PYTHON_MESH_ARRAYS_H_

#include <pybind11/numpy.h>

#include <vector>

#include "absl/status/statusor.h"
#include "client/mesh/mesh.h"
#include "client/mesh_files/parse_options.h"

namespace latvox::client::python {

// Returns the mesh. Its arrays are copies, because a call sends positions and faces as one run of bytes, and because it
// runs on while Python may change the arrays.
//   vertices   (n, 3) numbers, world
//   faces      each (m, k) integers, k >= 3: indices of vertices. Polygons are cut as those of files are
//   colors     (n, 3) uint8: red, green, blue of each vertex; or (0, 3): there are none
//   options    with skip_bad, faces are left out if an index is out of range or a corner is not finite
// Errors: INVALID_ARGUMENT naming array, row, value and limit: a shape or type of another kind, a number that is not
// finite, an index out of range, no face.
absl::StatusOr<Mesh> MeshOfArrays(const pybind11::array& vertices, const std::vector<pybind11::array>& faces,
                                  const pybind11::array& colors, const ParseOptions& options);

}  // namespace latvox::client::python

#endif  // LATVOX_CLIENT_PYTHON_MESH_ARRAYS_H_
