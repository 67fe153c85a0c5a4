#include "server/decode/draco_attributes.h"

#include <cmath>

#include "absl/strings/str_cat.h"
#include "server/base/errors.h"

namespace latvox {
namespace {

// Errors name the field of the request, because it asked for the attribute.
template <class... Words>
absl::Status Refuse(Field kind, const Words&... words) {
  return MakeError(absl::StatusCode::kInvalidArgument, absl::StrCat("fields: ", words...),
                   {"BAD_MESH", "fields", NameOf(kind), ""});
}

int IdOf(const draco::Mesh& mesh, Field kind) {
  if (kind == Field::kColor) return mesh.GetNamedAttributeId(draco::GeometryAttribute::COLOR);
  const int id = mesh.GetAttributeIdByMetadataEntry("name", NameOf(kind));
  return id >= 0 && mesh.attribute(id)->attribute_type() == draco::GeometryAttribute::GENERIC ? id : -1;
}

bool IsInteger(draco::DataType type) { return draco::DT_INT8 <= type && type <= draco::DT_UINT64; }

bool IsUnsigned(draco::DataType type) {
  return type == draco::DT_UINT8 || type == draco::DT_UINT16 || type == draco::DT_UINT32 || type == draco::DT_UINT64;
}

absl::Status CheckKind(const draco::PointAttribute& attribute, Field kind) {
  const int components = attribute.num_components();
  if (kind == Field::kColor) {
    if (components < 3) return Refuse(kind, "color has ", components, " components, not 3 or more");
    if (IsUnsigned(attribute.data_type()) || attribute.data_type() == draco::DT_FLOAT32) return absl::OkStatus();
    return Refuse(kind, "color holds neither unsigned integers nor 32-bit floats");
  }
  if (components != 1) return Refuse(kind, NameOf(kind), " has ", components, " components, not 1");
  return IsInteger(attribute.data_type()) ? absl::OkStatus() : Refuse(kind, NameOf(kind), " holds no integers");
}

// A whole number stands for its part of the largest one; Draco divides by that.
bool ReadColor(const draco::PointAttribute& attribute, draco::AttributeValueIndex value, uint32_t& out) {
  std::array<float, 3> color{};
  if (!attribute.ConvertValue<float>(value, 3, color.data())) return false;
  out = 0;
  for (const float x : color) {
    if (!(x >= 0 && x <= 1)) return false;
    out = out << 8 | static_cast<uint32_t>(std::nearbyint(double{x} * 255));
  }
  return true;
}

bool ReadIndex(const draco::PointAttribute& attribute, draco::AttributeValueIndex value, Field kind, uint32_t& out) {
  int64_t number = 0;
  if (!attribute.ConvertValue<int64_t>(value, 1, &number) || number < 0 || number > FactsOf(kind).largest) return false;
  out = static_cast<uint32_t>(number);
  return true;
}

}  // namespace

absl::Status CorruptDraco(absl::string_view detail) {
  return BadMesh(absl::StrCat("truncated or corrupt Draco data (", detail, ")"));
}

bool IsBacked(const draco::PointAttribute& attribute) {
  if (attribute.size() == 0 || attribute.buffer() == nullptr) return false;
  const uint64_t end = static_cast<uint64_t>(attribute.byte_offset()) +
                       static_cast<uint64_t>(attribute.byte_stride()) * attribute.size();
  return end <= attribute.buffer()->data_size();
}

absl::Status CheckValues(const draco::PointAttribute& attribute, uint32_t points, absl::string_view name) {
  if (!IsBacked(attribute)) return CorruptDraco(absl::StrCat(name, " has no values"));
  if (!attribute.is_mapping_identity() && attribute.indices_map_size() < points) return CorruptDraco("point map");
  return absl::OkStatus();
}

absl::StatusOr<DracoAttributes> DracoAttributes::Find(draco::Mesh& mesh, const FieldList& wanted) {
  DracoAttributes attributes;
  for (const Field kind : wanted.view()) {
    const int id = IdOf(mesh, kind);
    if (id < 0) return Refuse(kind, "the mesh has no ", NameOf(kind));
    draco::PointAttribute& attribute = *mesh.attribute(id);
    if (absl::Status status = CheckKind(attribute, kind); !status.ok()) return status;
    if (absl::Status status = CheckValues(attribute, mesh.num_points(), NameOf(kind)); !status.ok()) return status;
    // Draco takes this flag from the stream unchecked, as a bool of any value.
    attribute.set_normalized(kind == Field::kColor);
    attributes.found_.push_back({kind, &attribute});
  }
  return attributes;
}

absl::Status DracoAttributes::Read(uint32_t point, size_t n, uint32_t& out) const {
  const Found& found = found_[n];
  const draco::AttributeValueIndex value = found.attribute->mapped_index(draco::PointIndex(point));
  if (value.value() >= found.attribute->size()) {
    return CorruptDraco(absl::StrCat("vertex ", point, " has no ", NameOf(found.kind)));
  }
  if (found.kind == Field::kColor) {
    if (ReadColor(*found.attribute, value, out)) return absl::OkStatus();
    return Refuse(found.kind, "the color of vertex ", point, " is not within 0 and 1");
  }
  if (ReadIndex(*found.attribute, value, found.kind, out)) return absl::OkStatus();
  return Refuse(found.kind, "the ", NameOf(found.kind), " of vertex ", point, " is not within 0 and ",
                FactsOf(found.kind).largest);
}

}  // namespace latvox
