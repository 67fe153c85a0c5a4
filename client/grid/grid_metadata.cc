#include "client/grid/grid_metadata.h"

#include <string>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_join.h"

namespace latvox::client {

Metadata PlaceMetadata(const GridTransform& transform) {
  const auto& [a, b, c] = transform.basis;
  const std::vector<double> basis = {a[0], a[1], a[2], b[0], b[1], b[2], c[0], c[1], c[2]};
  const auto exactly = [](std::string* out, double x) { absl::StrAppendFormat(out, "%.17g", x); };
  return {{"latvox_voxel_size", ToMetadata(transform.voxel_size)},
          {"latvox_basis", ToMetadata(absl::StrJoin(basis, ",", exactly))},
          {"latvox_origin", ToMetadata(absl::StrJoin(transform.origin, ",", exactly))}};
}

Metadata CertificateMetadata(const Certificate& certificate) {
  Metadata metadata;
  const auto insert = [&metadata](const std::string& name, const auto& value) { metadata[name] = ToMetadata(value); };
  insert("latvox_lattice", certificate.lattice);
  insert("latvox_digest", certificate.digest);
  insert("latvox_algorithm", certificate.algorithm);
  insert("latvox_set", certificate.set);
  insert("latvox_version", certificate.version);
  insert("latvox_separability", static_cast<int32_t>(certificate.separability));
  insert("latvox_tunnel_free", certificate.tunnel_free);
  insert("latvox_minimal", certificate.minimal);
  insert("latvox_whole_minimal", certificate.whole_minimal);
  insert("latvox_verified", certificate.verified);
  insert("latvox_closed", certificate.closed);
  insert("latvox_snap_error_max", certificate.snap_error_max);
  insert("latvox_quantization_bits", static_cast<int32_t>(certificate.quantization_bits));
  if (const auto& shard = certificate.shard) {
    insert("latvox_shard", absl::StrCat(shard->index, "/", shard->count));
  }
  if (const auto& solid = certificate.solid) {
    insert("latvox_interior_rule", solid->rule);
    insert("latvox_unbalanced_lines", static_cast<int64_t>(solid->unbalanced_lines));
  }
  if (!certificate.interior_rule.empty()) insert("latvox_interior_rule", certificate.interior_rule);
  if (const auto& walk = certificate.walk) {
    insert("latvox_cavities", static_cast<int64_t>(walk->cavities));
  }
  if (const auto& band = certificate.band) insert("latvox_band_width", band->width);
  if (certificate.fields.empty()) return metadata;
  const auto name = [](std::string* out, const FieldCertificate& field) { *out += NameOf(field.field); };
  insert("latvox_fields", absl::StrJoin(certificate.fields, ",", name));
  for (const auto& [field, digest] : certificate.fields) {
    insert(absl::StrCat("latvox_", NameOf(field), "_digest"), digest);
    if (FactsOf(field).is_of_cell()) {
      insert("latvox_fraction_n", static_cast<int32_t>(certificate.fraction_n));
    }
    if (FactsOf(field).is_of_labels()) {
      insert("latvox_fraction_labels", absl::StrJoin(certificate.fraction_labels, ","));
    }
    if (field != Field::kDistance) continue;
    insert("latvox_signed_distance", certificate.signed_distance);
  }
  return metadata;
}

}  // namespace latvox::client
