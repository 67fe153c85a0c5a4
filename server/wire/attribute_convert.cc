#include "server/wire/attribute_convert.h"

#include <algorithm>
#include <string>

#include "absl/strings/str_cat.h"
#include "server/base/errors.h"

namespace latvox {
namespace {

absl::StatusOr<MeshAttribute> FromProto(int attribute) {
  switch (attribute) {
    case v1::ATTRIBUTE_PART:
      return MeshAttribute::kPart;
    case v1::ATTRIBUTE_MATERIAL:
      return MeshAttribute::kMaterial;
    case v1::ATTRIBUTE_COLOR:
      return MeshAttribute::kColor;
    default:
      return BadSpec(absl::StrCat("attributes: ", attribute, " is not an attribute"), "attributes",
                     absl::StrCat(attribute), "1 to 3");
  }
}

v1::Attribute ToProto(MeshAttribute attribute) {
  switch (attribute) {
    case MeshAttribute::kPart:
      return v1::ATTRIBUTE_PART;
    case MeshAttribute::kMaterial:
      return v1::ATTRIBUTE_MATERIAL;
    case MeshAttribute::kColor:
      return v1::ATTRIBUTE_COLOR;
  }
  return v1::ATTRIBUTE_UNSPECIFIED;
}

absl::Status CheckTogether(const VoxelizeOptions& options) {
  const auto refuse = [](const std::string& other) {
    return BadSpec(absl::StrCat("attributes: not together with ", other), "attributes", "");
  };
  if (options.solid) return refuse("fill.mode solid, whose inside no triangle is near to");
  if (options.band) return refuse("band");
  if (options.algorithm == Algorithm::kExact) return absl::OkStatus();
  return refuse(absl::StrCat("algorithm ", std::string{NameOf(options.algorithm)}));
}

}  // namespace

absl::StatusOr<MeshAttributes> AttributesFromProto(const v1::VoxelizeSpec& spec, const VoxelizeOptions& options) {
  MeshAttributes attributes;
  for (const int number : spec.attributes()) {
    const absl::StatusOr<MeshAttribute> attribute = FromProto(number);
    if (!attribute.ok()) return attribute.status();
    const absl::Span<const MeshAttribute> before = attributes.view();
    if (std::find(before.begin(), before.end(), *attribute) != before.end()) {
      return BadSpec(absl::StrCat("attributes: ", NameOf(*attribute), " stands twice"), "attributes",
                     NameOf(*attribute));
    }
    attributes.kinds[attributes.count++] = *attribute;
  }
  if (attributes.count == 0) return attributes;
  if (absl::Status status = CheckTogether(options); !status.ok()) return status;
  return attributes;
}

v1::AttributeCertificate AttributesToProto(const MeshAttributes& attributes, const JobTotals& totals) {
  v1::AttributeCertificate certificate;
  for (const MeshAttribute attribute : attributes.view()) certificate.add_attributes(ToProto(attribute));
  certificate.set_digest(totals.attributes.ToHex());
  return certificate;
}

}  // namespace latvox
