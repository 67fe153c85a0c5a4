#include "client/python/mesh_arrays.h"

#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <optional>
#include <string>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "client/mesh_files/polygon.h"
#include "latvox/error.h"

namespace latvox::client::python {
namespace {

namespace py = pybind11;

constexpr int kInOrder = py::array::c_style | py::array::forcecast;

template <class... Parts>
absl::Status Wrong(const std::string& field, const Parts&... parts) {
  absl::Status status = absl::InvalidArgumentError(absl::StrCat(field, parts...));
  SetErrorDetails({"BAD_MESH", field, "", "", std::nullopt}, status);
  return status;
}

std::string ShapeOf(const py::array& array) {
  return absl::StrCat("(", absl::StrJoin(array.shape(), array.shape() + array.ndim(), ", "), ")");
}

// Returns whether the array is a table of numbers whose kind is one of these letters of numpy.
bool IsTable(const py::array& array, const char* kinds) {
  return array.ndim() == 2 && std::strchr(kinds, array.dtype().kind()) != nullptr;
}

std::string KindOf(const py::array& array) {
  return absl::StrCat(": an array of shape ", ShapeOf(array), " and type ", std::string(py::str(array.dtype())));
}

absl::Status AddPositions(const py::array& given, Mesh& mesh) {
  if (!IsTable(given, "fiu") || given.shape(1) != 3) {
    return Wrong("vertices", KindOf(given), " is not (n, 3) numbers");
  }
  const auto vertices = py::array_t<double, kInOrder>::ensure(given);
  static_assert(sizeof(Vec3d) == 3 * sizeof(double));
  mesh.positions.resize(static_cast<size_t>(vertices.shape(0)));
  std::memcpy(mesh.positions.data(), vertices.data(), mesh.positions.size() * sizeof(Vec3d));
  for (size_t v = 0; v < mesh.positions.size(); ++v) {
    for (const double x : mesh.positions[v]) {
      if (!std::isfinite(x)) return Wrong("vertices", "[", v, "]: ", x, " is not finite");
    }
  }
  if (mesh.positions.size() > std::numeric_limits<uint32_t>::max()) {
    return Wrong("vertices", ": ", mesh.positions.size(), " exceed ", std::numeric_limits<uint32_t>::max());
  }
  return absl::OkStatus();
}

absl::Status AddFaces(const py::array& given, Mesh& mesh) {
  if (!IsTable(given, "iu") || given.shape(1) < 3) {
    return Wrong("faces", KindOf(given), " is not (m, 3) integers, or more of them in a row");
  }
  const auto faces = py::array_t<int64_t, kInOrder>::ensure(given);
  const size_t corners = static_cast<size_t>(faces.shape(1)), count = mesh.positions.size();
  std::vector<uint32_t> face(corners);
  mesh.triangles.reserve(mesh.triangles.size() + static_cast<size_t>(faces.shape(0)) * (corners - 2));
  const int64_t* next = faces.data();
  for (py::ssize_t f = 0; f < faces.shape(0); ++f) {
    for (uint32_t& corner : face) {
      const int64_t index = *next++;
      if (index < 0 || static_cast<uint64_t>(index) >= count) {
        return Wrong("faces", "[", f, "]: index ", index, " is not within 0 and ", count, ", the number of vertices");
      }
      corner = static_cast<uint32_t>(index);
    }
    if (corners == 3) {
      mesh.triangles.push_back({face[0], face[1], face[2]});
    } else {
      Triangulate(face, mesh.positions, mesh.triangles);
    }
  }
  return absl::OkStatus();
}

absl::Status AddColors(const py::array& given, Mesh& mesh) {
  if (!IsTable(given, "u") || given.itemsize() != 1 || given.shape(1) != 3 ||
      (given.shape(0) != 0 && static_cast<size_t>(given.shape(0)) != mesh.positions.size())) {
    return Wrong("colors", KindOf(given), " is not (", mesh.positions.size(), ", 3) uint8, one row for each vertex");
  }
  const auto colors = py::array_t<uint8_t, kInOrder>::ensure(given);
  mesh.colors.resize(static_cast<size_t>(colors.shape(0)));
  std::memcpy(mesh.colors.data(), colors.data(), mesh.colors.size() * sizeof(Color));
  return absl::OkStatus();
}

}  // namespace

absl::StatusOr<Mesh> MeshOfArrays(const py::array& vertices, const std::vector<py::array>& faces,
                                  const py::array& colors) {
  Mesh mesh;
  if (absl::Status status = AddPositions(vertices, mesh); !status.ok()) return status;
  for (const py::array& one : faces) {
    if (absl::Status status = AddFaces(one, mesh); !status.ok()) return status;
  }
  if (mesh.triangles.empty()) return Wrong("faces", ": the mesh has none");
  if (absl::Status status = AddColors(colors, mesh); !status.ok()) return status;
  return mesh;
}

}  // namespace latvox::client::python
