#include "client/python/mesh_arrays.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <optional>
#include <string>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "client/mesh/affine.h"
#include "client/mesh/mesh_attributes.h"
#include "client/mesh_files/bad_elements.h"
#include "client/mesh_files/mesh_join.h"
#include "client/mesh_files/polygon.h"
#include "client/mesh_files/triangle_colors.h"
#include "latvox/error.h"

namespace latvox::client::python {
namespace {

namespace py = pybind11;

constexpr int kInOrder = py::array::c_style | py::array::forcecast;

template <class... Parts>
absl::Status Wrong(const std::string& field, const std::string& value, const std::string& limit,
                   const Parts&... parts) {
  absl::Status status = absl::InvalidArgumentError(absl::StrCat(field, parts...));
  SetErrorDetails({"BAD_MESH", field, value, limit, std::nullopt}, status);
  return status;
}

std::string ShapeOf(const py::array& array) {
  return absl::StrCat("(", absl::StrJoin(array.shape(), array.shape() + array.ndim(), ", "), ")");
}

// Returns whether the array is a table of numbers whose kind is one of these letters of numpy.
bool IsTable(const py::array& array, const char* kinds) {
  return array.ndim() == 2 && std::strchr(kinds, array.dtype().kind()) != nullptr;
}

// Returns the error of an array whose shape or type is not the wanted one.
absl::Status WrongKind(const std::string& field, const py::array& given, const std::string& wanted) {
  const std::string kind =
      absl::StrCat("an array of shape ", ShapeOf(given), " and type ", std::string(py::str(given.dtype())));
  return Wrong(field, kind, wanted, ": ", kind, " is not ", wanted);
}

absl::Status NotFinite(size_t vertex, const Vec3d& position) {
  const double x = *std::find_if_not(position.begin(), position.end(), [](double one) { return std::isfinite(one); });
  return Wrong("vertices", absl::StrCat(x), "finite numbers", "[", vertex, "]: ", x, " is not finite");
}

// Returns the array, or a copy if its numbers may lie where the processor does not read such numbers, as those of a
// packed record do.
py::array Aligned(const py::array& given) {
  const bool is_aligned = (given.flags() & py::detail::npy_api::NPY_ARRAY_ALIGNED_) != 0;
  return is_aligned ? given : py::array(given.attr("copy")());
}

// Calls take(rows) with the array as it is if its numbers are of the type T; otherwise returns false.
template <class T, class Take>
bool TakeAs(const py::array& given, const Take& take) {
  if (!py::isinstance<py::array_t<T>>(given)) return false;
  take(given.cast<py::array_t<T>>());
  return true;
}

// Returns the positions of a table of three columns, of any strides.
template <class T>
std::vector<Vec3d> PositionsOf(const py::array_t<T>& given) {
  const auto rows = given.template unchecked<2>();
  std::vector<Vec3d> positions(static_cast<size_t>(rows.shape(0)));
  for (py::ssize_t n = 0; n < rows.shape(0); ++n) {
    for (py::ssize_t m = 0; m < 3; ++m) {
      positions[static_cast<size_t>(n)][static_cast<size_t>(m)] = static_cast<double>(rows(n, m));
    }
  }
  return positions;
}

absl::Status AddPositions(const py::array& asked, bool skip_bad, Mesh& mesh) {
  const py::array given = Aligned(asked);
  if (!IsTable(given, "fiu") || given.shape(1) != 3) return WrongKind("vertices", given, "(n, 3) numbers");
  const auto take = [&mesh](const auto& rows) { mesh.positions = PositionsOf(rows); };
  if (!TakeAs<double>(given, take) && !TakeAs<float>(given, take)) {
    TakeAs<double>(py::array_t<double, kInOrder>::ensure(given), take);  // other numbers take a copy of their own
  }
  if (mesh.positions.size() > std::numeric_limits<uint32_t>::max()) {
    const std::string count = absl::StrCat(mesh.positions.size()),
                      most = absl::StrCat(std::numeric_limits<uint32_t>::max());
    return Wrong("vertices", count, most, ": ", count, " exceed ", most);
  }
  const auto bad = std::find_if_not(mesh.positions.begin(), mesh.positions.end(), IsFinite);
  if (skip_bad || bad == mesh.positions.end()) return absl::OkStatus();
  return NotFinite(static_cast<size_t>(bad - mesh.positions.begin()), *bad);
}

// Returns the error of row `f`, whose indices may be out of range.
absl::Status CheckFace(py::ssize_t f, const int64_t* indices, size_t corners, const Mesh& mesh) {
  const size_t count = mesh.positions.size();
  for (size_t n = 0; n < corners; ++n) {
    const int64_t index = indices[n];
    if (index < 0 || static_cast<uint64_t>(index) >= count) {
      return Wrong("faces", absl::StrCat(index), absl::StrCat("0 to below ", count), "[", f, "]: index ", index,
                   " is not within 0 and ", count, ", the number of vertices");
    }
    const Vec3d& position = mesh.positions[static_cast<size_t>(index)];
    if (!IsFinite(position)) return NotFinite(static_cast<size_t>(index), position);
  }
  return absl::OkStatus();
}

// Colors of faces, and of the triangles that they become.
struct FaceColors {
  std::vector<Color> of_faces;  // none, or one for each face of all arrays
  std::vector<std::optional<Color>> of_triangles = {};

  // Gives the triangles that are new in the mesh the color of their face.
  void Add(size_t face, const Mesh& mesh) {
    if (!of_faces.empty()) of_triangles.resize(mesh.triangles.size(), of_faces[face]);
  }
};

// Adds the faces of a table of any strides. `first` is the number of faces in the arrays before.
template <class T>
absl::Status AddRows(const py::array_t<T>& given, size_t first, BadElements& bad, FaceColors& colors, Mesh& mesh) {
  const auto rows = given.template unchecked<2>();
  const auto corners = static_cast<size_t>(rows.shape(1));
  std::vector<int64_t> indices(corners);
  std::vector<uint32_t> face(corners);
  mesh.triangles.reserve(mesh.triangles.size() + static_cast<size_t>(rows.shape(0)) * (corners - 2));
  for (py::ssize_t f = 0; f < rows.shape(0); ++f) {
    for (size_t n = 0; n < corners; ++n) indices[n] = static_cast<int64_t>(rows(f, static_cast<py::ssize_t>(n)));
    if (absl::Status wrong = CheckFace(f, indices.data(), corners, mesh); !wrong.ok()) {
      if (absl::Status status = bad.Add(wrong, absl::StrCat("faces[", f, "]")); !status.ok()) return status;
      continue;
    }
    std::ranges::transform(indices, face.begin(), [](int64_t index) { return static_cast<uint32_t>(index); });
    if (corners == 3) {
      mesh.triangles.push_back({face[0], face[1], face[2]});
    } else {
      Triangulate(face, mesh.positions, mesh.triangles);
    }
    colors.Add(first + static_cast<size_t>(f), mesh);
  }
  return absl::OkStatus();
}

absl::Status AddFaces(const py::array& asked, size_t first, BadElements& bad, FaceColors& colors, Mesh& mesh) {
  const py::array given = Aligned(asked);
  if (!IsTable(given, "iu") || given.shape(1) < 3) {
    return WrongKind("faces", given, "(m, 3) integers, or more of them in a row");
  }
  absl::Status status;
  const auto take = [&](const auto& rows) { status = AddRows(rows, first, bad, colors, mesh); };
  if (!TakeAs<int32_t>(given, take) && !TakeAs<int64_t>(given, take) && !TakeAs<uint32_t>(given, take)) {
    TakeAs<int64_t>(py::array_t<int64_t, kInOrder>::ensure(given), take);  // other integers take a copy of their own
  }
  return status;
}

size_t RowsOf(const py::array& array) { return array.ndim() == 0 ? 0 : static_cast<size_t>(array.shape(0)); }

// Returns the rows of an array of colors: none, or `count`.
absl::StatusOr<std::vector<Color>> ReadColors(const char* field, const py::array& given, size_t count,
                                              const char* element) {
  if (!IsTable(given, "u") || given.itemsize() != 1 || given.shape(1) != 3 ||
      (RowsOf(given) != 0 && RowsOf(given) != count)) {
    return WrongKind(field, given, absl::StrCat("(", count, ", 3) uint8, one row for each ", element));
  }
  const auto rows = py::array_t<uint8_t, kInOrder>::ensure(given);
  std::vector<Color> colors(RowsOf(rows));
  std::memcpy(colors.data(), rows.data(), colors.size() * sizeof(Color));
  return colors;
}

absl::Status AddPart(const PartArrays& part, const ParseOptions& options, Mesh& mesh) {
  BadElements bad(options);
  if (absl::Status status = AddPositions(part.vertices, options.skip_bad, mesh); !status.ok()) return status;
  auto colors = ReadColors("colors", part.colors, mesh.positions.size(), "vertex");
  if (!colors.ok()) return colors.status();
  size_t faces = 0;
  for (const py::array& one : part.faces) faces += RowsOf(one);
  auto of_faces = ReadColors("face_colors", part.face_colors, faces, "face");
  if (!of_faces.ok()) return of_faces.status();
  FaceColors face_colors{*std::move(of_faces)};
  size_t first = 0;
  for (const py::array& one : part.faces) {
    if (absl::Status status = AddFaces(one, first, bad, face_colors, mesh); !status.ok()) return status;
    first += RowsOf(one);
  }
  bad.Report(mesh);
  if (mesh.triangles.empty()) return Wrong("faces", "", "", ": the mesh has none", LeftOut(mesh));
  mesh.no_color = part.no_color;
  mesh.colors = *std::move(colors);
  if (!mesh.colors.empty() && !face_colors.of_faces.empty()) {
    WarnOfFaceColors(mesh);
  } else if (!face_colors.of_faces.empty()) {
    ColorTriangles(face_colors.of_triangles, mesh);
  }
  RemoveNotFinite(mesh);
  SetName(0, part.name, mesh.part_names);
  return absl::OkStatus();
}

absl::Status WithPrefix(const std::string& prefix, const absl::Status& error) {
  absl::Status status(error.code(), absl::StrCat(prefix, error.message()));
  SetErrorDetails(GetErrorDetails(error), status);
  return status;
}

}  // namespace

absl::StatusOr<Mesh> MeshOfArrays(const std::vector<PartArrays>& parts, const ParseOptions& options) {
  Mesh mesh;
  for (size_t n = 0; n < parts.size(); ++n) {
    const std::string named = parts[n].name.empty() ? "" : absl::StrCat(" (", parts[n].name, ")"),
                      prefix = parts.size() == 1 ? "" : absl::StrCat("part ", n, named, ": ");
    Mesh part;
    absl::Status status = AddPart(parts[n], options, part);
    for (Warning& warning : part.warnings) warning.message = prefix + warning.message;
    if (status.ok()) status = Append(std::move(part), kIdentity, mesh);
    if (!status.ok()) return WithPrefix(prefix, status);
  }
  return mesh;
}

}  // namespace latvox::client::python
