// The values that voxels carry. Field in proto/latvox/v1/voxelizer.proto describes them.
#ifndef LATVOX_LATVOX_FIELDS_H_
#define LATVOX_LATVOX_FIELDS_H_

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <vector>

namespace latvox::client {

// The values that voxels can carry, of the nearest triangle or for each neighbor: see Field in the protocol.
enum class Field {
  kPart,      // the part of the mesh
  kMaterial,  // the material
  kColor,     // red, green, blue
  kDistance,  // the distance to the mesh, world units; negative inside with VoxelizeRequest::signed_distance
  kTriangle,  // the number of the nearest triangle in the mesh as sent
  kPoint,     // its nearest point, as weights of its second and third corner
  kNormal,    // its unit normal in the world: x, y, z
  // The next three have a number for each of Accepted::neighbors.
  kLinks,          // the share of the link's length at which it first meets the mesh; NaN: it is not crossed
  kLinkTriangles,  // the number of the triangle that it meets first; 4294967295: it is not crossed
  kLinkCrossings,  // the number of triangles that cross the link
  // How many of the n^3 points of the voxel's cell are inside of the mesh, n being VoxelizeRequest::fraction_n.
  kFraction,
  // The same for each of Accepted::fraction_labels: only points of a labeled solid that have this label.
  kLabelFractions,
};

// The types of a field's components.
enum class NumberType {
  kUint8,    // unsigned, 8 bits
  kUint16,   // unsigned, 16 bits, little-endian
  kUint32,   // unsigned, 32 bits, little-endian
  kFloat32,  // IEEE 754, 32 bits, little-endian
};

// As FieldFacts::components: a component for each of Accepted::neighbors.
inline constexpr size_t kOneForEachNeighbor = 0;
// As FieldFacts::components: a component for each of Accepted::fraction_labels.
inline constexpr size_t kOneForEachLabel = static_cast<size_t>(-1);

// A field's name, and the form of its values.
struct FieldFacts {
  Field field;        // the field of this row
  const char* name;   // in the protocol, in files and on the command line
  NumberType type;    // of each component
  size_t components;  // of a voxel, or one of the constants above
  bool is_of_mesh;    // each vertex of the mesh has a number for it

  // Returns whether a voxel has a number for each neighbor.
  constexpr bool is_of_links() const { return components == kOneForEachNeighbor; }
  // Returns whether a voxel has a number for each label.
  constexpr bool is_of_labels() const { return components == kOneForEachLabel; }
  // Returns whether the values depend on the order of the mesh's triangles, which Draco changes. For a normal, it
  // decides among triangles at the same distance.
  constexpr bool needs_order() const {
    return field == Field::kTriangle || field == Field::kPoint || field == Field::kNormal ||
           field == Field::kLinkTriangles;
  }
  // Returns whether the numbers count points of a voxel's cell.
  constexpr bool is_of_cell() const { return field == Field::kFraction || field == Field::kLabelFractions; }
};

// The most neighbors of a lattice point, of all lattices.
inline constexpr size_t kMostNeighbors = 26;

// The most labels whose fractions a voxel carries.
inline constexpr size_t kMostFractionLabels = 32;

// All fields, in the order of their values.
inline constexpr std::array kFields{
    FieldFacts{Field::kPart, "part", NumberType::kUint32, 1, true},
    FieldFacts{Field::kMaterial, "material", NumberType::kUint32, 1, true},
    FieldFacts{Field::kColor, "color", NumberType::kUint8, 3, true},
    FieldFacts{Field::kDistance, "distance", NumberType::kFloat32, 1, false},
    FieldFacts{Field::kTriangle, "triangle", NumberType::kUint32, 1, false},
    FieldFacts{Field::kPoint, "point", NumberType::kFloat32, 2, false},
    FieldFacts{Field::kNormal, "normal", NumberType::kFloat32, 3, false},
    FieldFacts{Field::kLinks, "links", NumberType::kFloat32, kOneForEachNeighbor, false},
    FieldFacts{Field::kLinkTriangles, "link_triangles", NumberType::kUint32, kOneForEachNeighbor, false},
    FieldFacts{Field::kLinkCrossings, "link_crossings", NumberType::kUint32, kOneForEachNeighbor, false},
    FieldFacts{Field::kFraction, "fraction", NumberType::kUint16, 1, false},
    FieldFacts{Field::kLabelFractions, "label_fractions", NumberType::kUint16, kOneForEachLabel, false},
};

// Returns the row of a field.
constexpr const FieldFacts& FactsOf(Field field) { return kFields[static_cast<size_t>(field)]; }

// Returns its name, for example "part" or "link_triangles".
constexpr const char* NameOf(Field field) { return FactsOf(field).name; }

// Returns whether the field is among these.
inline bool CarriesField(std::span<const Field> fields, Field field) {
  for (const Field one : fields) {
    if (one == field) return true;
  }
  return false;
}

// Returns whether a field among these has a number for each neighbor.
inline bool CarriesLinks(std::span<const Field> fields) {
  for (const Field one : fields) {
    if (FactsOf(one).is_of_links()) return true;
  }
  return false;
}

// Returns the name of a label's fractions in files: "fraction_7".
inline std::string FractionName(uint32_t label) { return "fraction_" + std::to_string(label); }

// Returns the name of a field of links in files, for one neighbor: "link_-1_0_1", "link_triangle_-1_0_1".
// Precondition: it is a field of links.
//   step   lattice vector to the neighbor
inline std::string LinkName(Field field, const std::array<int32_t, 3>& step) {
  std::string name = field == Field::kLinkTriangles   ? "link_triangle"
                     : field == Field::kLinkCrossings ? "link_crossings"
                                                      : "link";
  for (const int32_t coordinate : step) name += "_" + std::to_string(coordinate);
  return name;
}

// The values of voxels for one field, without gaps: bytes_of_voxel for each voxel, brick after brick, and within a
// brick in lexicographic order of ijk.
struct FieldValues {
  Field field = Field::kPart;         // the field that voxels carry
  std::vector<std::byte> bytes = {};  // little-endian
  size_t neighbors = 0;               // of a voxel, for a field with a number for each neighbor
  std::vector<uint32_t> labels = {};  // in the order of a voxel's numbers, for a field with a number for each label

  // Returns the numbers of a voxel.
  size_t components() const {
    const FieldFacts& facts = FactsOf(field);
    return facts.is_of_links() ? neighbors : facts.is_of_labels() ? labels.size() : facts.components;
  }
  // Returns the bytes of a voxel.
  size_t bytes_of_voxel() const {
    const NumberType type = FactsOf(field).type;
    return components() * (type == NumberType::kUint8 ? 1 : type == NumberType::kUint16 ? 2 : 4);
  }

  // Returns all components. T is uint8_t, uint16_t, uint32_t or float, as FieldFacts::type says.
  template <class T>
  std::span<const T> As() const {
    return {reinterpret_cast<const T*>(bytes.data()), bytes.size() / sizeof(T)};
  }
  bool operator==(const FieldValues&) const = default;
};

// Returns whether the mesh crosses the n-th of all links. Links are numbered from 0, in the order of the values.
// Precondition: a field of links.
inline bool IsCrossed(const FieldValues& links, size_t n) {
  if (links.field == Field::kLinks) return !std::isnan(links.As<float>()[n]);
  const uint32_t number = links.As<uint32_t>()[n];
  return links.field == Field::kLinkTriangles ? number != std::numeric_limits<uint32_t>::max() : number != 0;
}

// Returns the values of a field, or null if there are none.
inline const FieldValues* FindField(std::span<const FieldValues> fields, Field field) {
  for (const FieldValues& values : fields) {
    if (values.field == field) return &values;
  }
  return nullptr;
}

}  // namespace latvox::client

#endif  // LATVOX_LATVOX_FIELDS_H_
