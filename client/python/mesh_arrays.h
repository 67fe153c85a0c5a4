// Meshes from arrays of numpy.
#ifndef LATVOX_CLIENT_PYTHON_MESH_ARRAYS_H_
#define LATVOX_CLIENT_PYTHON_MESH_ARRAYS_H_

#include <pybind11/numpy.h>

#include <optional>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "client/mesh/mesh.h"
#include "client/mesh_files/parse_options.h"

namespace latvox::client::python {

// One part of a mesh.
//   vertices      (n, 3) numbers, world
//   faces         each (m, k) integers, k >= 3: indices of vertices. Polygons are cut as those of files are
//   sizes         (m,) integers, each >= 3: then there is one array of faces, (c,), with the corners of m faces of
//                 these sizes
//   colors        (n, 3) uint8: red, green, blue of each vertex; or (0, 3): there are none
//   face_colors   likewise of each face, in the order of `faces`. Those of vertices count before them
//   no_color      why there are no colors, for the error of a call that needs them
struct PartArrays {
  pybind11::array vertices;
  std::vector<pybind11::array> faces;
  std::optional<pybind11::array> sizes;
  pybind11::array colors, face_colors;
  std::string name, no_color;  // the name may be empty
};

// Returns the mesh of all parts, numbered in their order. Its arrays are copies, because a call sends positions and
// faces as one run of bytes, and because it runs on while Python may change the arrays.
//   options   with skip_bad, faces are left out if an index is out of range or a corner is not finite
// Errors: INVALID_ARGUMENT naming array, row, value and limit, and the part if there are several: a shape or type of
// another kind, a number that is not finite, an index out of range, no face.
absl::StatusOr<Mesh> MeshOfArrays(const std::vector<PartArrays>& parts, const ParseOptions& options);

}  // namespace latvox::client::python

#endif  // LATVOX_CLIENT_PYTHON_MESH_ARRAYS_H_
