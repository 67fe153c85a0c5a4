// The attributes of decoded Draco meshes, which may be hostile, as numbers.
#ifndef LATVOX_SERVER_DECODE_DRACO_ATTRIBUTES_H_
#define LATVOX_SERVER_DECODE_DRACO_ATTRIBUTES_H_

#include <draco/mesh/mesh.h>

#include <cstdint>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "core/request/fields.h"

namespace latvox {

absl::Status CorruptDraco(absl::string_view detail);

// Whether all values that the attribute claims to have lie in its buffer.
bool IsBacked(const draco::PointAttribute& attribute);

// INVALID_ARGUMENT unless the attribute has values, and a mapping to them for each of `points`.
//   name   for the error
absl::Status CheckValues(const draco::PointAttribute& attribute, uint32_t points, absl::string_view name);

class DracoAttributes {
 public:
  // Errors: INVALID_ARGUMENT naming the attribute that the mesh lacks, or that does not hold numbers of its kind.
  // The mesh must outlive them; the flags of its attributes are set as they are read.
  static absl::StatusOr<DracoAttributes> Find(draco::Mesh& mesh, const FieldList& wanted);

  uint32_t count() const { return static_cast<uint32_t>(found_.size()); }

  // The number of the n-th attribute that was wanted. Errors: INVALID_ARGUMENT naming point, attribute and limit.
  absl::Status Read(uint32_t point, size_t n, uint32_t& out) const;

 private:
  struct Found {
    Field kind;
    const draco::PointAttribute* attribute;
  };
  std::vector<Found> found_;
};

}  // namespace latvox

#endif  // LATVOX_SERVER_DECODE_DRACO_ATTRIBUTES_H_
