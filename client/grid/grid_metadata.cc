#include "client/grid/grid_metadata.h"

#include <array>
#include <charconv>
#include <memory>
#include <string>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_join.h"

namespace latvox::client {
namespace {

void Insert(openvdb::GridBase& grid, const char* name, const std::string& value) {
  grid.insertMeta(name, openvdb::StringMetadata(value));
}

}  // namespace

std::string MetadataText(const openvdb::Metadata& metadata) {
  const auto* number = dynamic_cast<const openvdb::DoubleMetadata*>(&metadata);
  if (number == nullptr) return metadata.str();
  std::array<char, 32> text;
  return {text.data(), std::to_chars(text.data(), text.data() + text.size(), number->value()).ptr};
}

// OpenVDB multiplies row vectors: (i, j, k, 1) * M, so the basis vectors and the origin are M's rows. Transform turns a
// plain scale into a scale map, which some programs read faster. The origin is added afterwards, because OpenVDB
// computes the scale as a difference of positions, which would lose digits far from the origin.
openvdb::math::Transform::Ptr MakeTransform(const GridTransform& transform) {
  const auto& [a, b, c] = transform.basis;
  const openvdb::Mat4d matrix(a[0], a[1], a[2], 0., b[0], b[1], b[2], 0., c[0], c[1], c[2], 0., 0., 0., 0., 1.);
  auto made = std::make_shared<openvdb::math::Transform>(std::make_shared<openvdb::math::AffineMap>(matrix));
  const openvdb::Vec3d origin(transform.origin.data());
  if (origin != openvdb::Vec3d(0.)) made->postTranslate(origin);
  return made;
}

void Place(const GridTransform& transform, openvdb::GridBase& grid) {
  grid.setTransform(MakeTransform(transform));
  grid.insertMeta("latvox_voxel_size", openvdb::DoubleMetadata(transform.voxel_size));
  const auto& [a, b, c] = transform.basis;
  const std::vector<double> basis = {a[0], a[1], a[2], b[0], b[1], b[2], c[0], c[1], c[2]};
  const auto exactly = [](std::string* out, double x) { absl::StrAppendFormat(out, "%.17g", x); };
  Insert(grid, "latvox_basis", absl::StrJoin(basis, ",", exactly));
  Insert(grid, "latvox_origin", absl::StrJoin(transform.origin, ",", exactly));
}

void InsertMetadata(const openvdb::MetaMap& metadata, openvdb::GridBase& grid) {
  for (auto each = metadata.beginMeta(); each != metadata.endMeta(); ++each) {
    const bool is_own =
        each->first == openvdb::GridBase::META_GRID_NAME || each->first == openvdb::GridBase::META_GRID_CLASS;
    if (!is_own) grid.insertMeta(each->first, *each->second);
  }
}

void Describe(const Certificate& certificate, openvdb::GridBase& grid) {
  Insert(grid, "latvox_lattice", certificate.lattice);
  Insert(grid, "latvox_digest", certificate.digest);
  Insert(grid, "latvox_algorithm", certificate.algorithm);
  Insert(grid, "latvox_set", certificate.set);
  Insert(grid, "latvox_version", certificate.version);
  grid.insertMeta("latvox_separability", openvdb::Int32Metadata(static_cast<int32_t>(certificate.separability)));
  grid.insertMeta("latvox_tunnel_free", openvdb::BoolMetadata(certificate.tunnel_free));
  grid.insertMeta("latvox_minimal", openvdb::BoolMetadata(certificate.minimal));
  grid.insertMeta("latvox_whole_minimal", openvdb::BoolMetadata(certificate.whole_minimal));
  grid.insertMeta("latvox_verified", openvdb::BoolMetadata(certificate.verified));
  grid.insertMeta("latvox_closed", openvdb::BoolMetadata(certificate.closed));
  grid.insertMeta("latvox_snap_error_max", openvdb::DoubleMetadata(certificate.snap_error_max));
  grid.insertMeta("latvox_quantization_bits",
                  openvdb::Int32Metadata(static_cast<int32_t>(certificate.quantization_bits)));
  if (const auto& shard = certificate.shard) {
    Insert(grid, "latvox_shard", absl::StrCat(shard->index, "/", shard->count));
  }
  if (const auto& solid = certificate.solid) {
    Insert(grid, "latvox_interior_rule", solid->rule);
    grid.insertMeta("latvox_unbalanced_lines", openvdb::Int64Metadata(static_cast<int64_t>(solid->unbalanced_lines)));
  }
  if (!certificate.interior_rule.empty()) Insert(grid, "latvox_interior_rule", certificate.interior_rule);
  if (const auto& walk = certificate.walk) {
    grid.insertMeta("latvox_cavities", openvdb::Int64Metadata(static_cast<int64_t>(walk->cavities)));
  }
  if (const auto& band = certificate.band) grid.insertMeta("latvox_band_width", openvdb::DoubleMetadata(band->width));
  if (certificate.fields.empty()) return;
  const auto name = [](std::string* out, const FieldCertificate& field) { *out += NameOf(field.field); };
  Insert(grid, "latvox_fields", absl::StrJoin(certificate.fields, ",", name));
  for (const auto& [field, digest] : certificate.fields) {
    Insert(grid, absl::StrCat("latvox_", NameOf(field), "_digest").c_str(), digest);
    if (FactsOf(field).is_of_cell()) {
      grid.insertMeta("latvox_fraction_n", openvdb::Int32Metadata(static_cast<int32_t>(certificate.fraction_n)));
    }
    if (FactsOf(field).is_of_labels()) {
      Insert(grid, "latvox_fraction_labels", absl::StrJoin(certificate.fraction_labels, ","));
    }
    if (field != Field::kDistance) continue;
    grid.insertMeta("latvox_signed_distance", openvdb::BoolMetadata(certificate.signed_distance));
  }
}

}  // namespace latvox::client
