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
template <class T>
absl::Status CheckFace(py::ssize_t f, const std::vector<T>& indices, const Mesh& mesh) {
  const size_t count = mesh.positions.size();
  for (const T index : indices) {
    if (std::cmp_less(index, 0) || std::cmp_greater_equal(index, count)) {
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

// Adds faces to a mesh whose positions are known.
class FaceAdder {
 public:
  FaceAdder(BadElements& bad, FaceColors& colors, Mesh& mesh) : bad_(bad), colors_(colors), mesh_(mesh) {}

  // Adds the faces of a table, of any strides.
  absl::Status AddTable(const py::array& asked) {
    const py::array given = Aligned(asked);
    if (!IsTable(given, "iu") || given.shape(1) < 3) {
      return WrongKind("faces", given, "(m, 3) integers, or more of them in a row");
    }
    absl::Status status;
    const auto take = [&](const auto& table) { status = AddRows(table); };
    if (TakeAs<int32_t>(given, take) || TakeAs<int64_t>(given, take) || TakeAs<uint32_t>(given, take)) return status;
    // Other integers take a copy of their own, which has the same values.
    if (given.dtype().kind() == 'u') {
      TakeAs<uint64_t>(py::array_t<uint64_t, kInOrder>::ensure(given), take);
    } else {
      TakeAs<int64_t>(py::array_t<int64_t, kInOrder>::ensure(given), take);
    }
    return status;
  }

  // Adds faces of these sizes, whose corners follow each other.
  absl::Status AddList(const py::array& corners, const py::array& sizes) {
    const auto all = py::array_t<int64_t, kInOrder>::ensure(corners),
               counts = py::array_t<int64_t, kInOrder>::ensure(sizes);
    const int64_t* next = all.data();
    std::vector<int64_t> face;
    for (py::ssize_t f = 0; f < counts.size(); next += counts.data()[f++]) {
      face.assign(next, next + counts.data()[f]);
      if (absl::Status status = Add(f, face); !status.ok()) return status;
    }
    return absl::OkStatus();
  }

 private:
  template <class T>
  absl::Status AddRows(const py::array_t<T>& given) {
    const auto rows = given.template unchecked<2>();
    std::vector<T> face(static_cast<size_t>(rows.shape(1)));
    for (py::ssize_t f = 0; f < rows.shape(0); ++f) {
      for (py::ssize_t n = 0; n < rows.shape(1); ++n) face[static_cast<size_t>(n)] = rows(f, n);
      if (absl::Status status = Add(f, face); !status.ok()) return status;
    }
    return absl::OkStatus();
  }

  // Adds the face of row `f`.
  template <class T>
  absl::Status Add(py::ssize_t f, const std::vector<T>& face) {
    const size_t number = faces_++;
    if (absl::Status wrong = CheckFace(f, face, mesh_); !wrong.ok()) {
      return bad_.Add(wrong, absl::StrCat("faces[", f, "]"));
    }
    polygon_.resize(face.size());
    std::ranges::transform(face, polygon_.begin(), [](T index) { return static_cast<uint32_t>(index); });
    if (polygon_.size() == 3) {
      mesh_.triangles.push_back({polygon_[0], polygon_[1], polygon_[2]});
    } else {
      Triangulate(polygon_, mesh_.positions, mesh_.triangles);
    }
    colors_.Add(number, mesh_);
    return absl::OkStatus();
  }

  BadElements& bad_;
  FaceColors& colors_;
  Mesh& mesh_;
  size_t faces_ = 0;  // so far, of all arrays
  std::vector<uint32_t> polygon_;
};

size_t RowsOf(const py::array& array) { return array.ndim() == 0 ? 0 : static_cast<size_t>(array.shape(0)); }

size_t FacesOf(const PartArrays& part) {
  if (part.sizes) return RowsOf(*part.sizes);
  size_t faces = 0;
  for (const py::array& table : part.faces) faces += RowsOf(table);
  return faces;
}

// Returns the number of triangles that the faces become, if they are as they should be.
size_t TrianglesOf(const PartArrays& part) {
  if (part.sizes) return RowsOf(part.faces.front()) - 2 * RowsOf(*part.sizes);
  size_t triangles = 0;
  for (const py::array& table : part.faces) {
    if (table.ndim() == 2 && table.shape(1) > 2) triangles += RowsOf(table) * static_cast<size_t>(table.shape(1) - 2);
  }
  return triangles;
}

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
  auto of_faces = ReadColors("face_colors", part.face_colors, FacesOf(part), "face");
  if (!of_faces.ok()) return of_faces.status();
  FaceColors face_colors{*std::move(of_faces)};
  FaceAdder faces(bad, face_colors, mesh);
  mesh.triangles.reserve(TrianglesOf(part));  // once: a mesh may have an array for each of its faces
  if (part.sizes) {
    if (absl::Status status = faces.AddList(part.faces.front(), *part.sizes); !status.ok()) return status;
  } else {
    for (const py::array& table : part.faces) {
      if (absl::Status status = faces.AddTable(table); !status.ok()) return status;
    }
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
