// Reads attributes of decoded Draco meshes, which may be hostile, as numbers.
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

// Returns whether all values that the attribute declares lie in its buffer.
bool IsBacked(const draco::PointAttribute& attribute);

// Returns INVALID_ARGUMENT unless the attribute has values, and maps each of `points` to one.
//   name   for the error
absl::Status CheckValues(const draco::PointAttribute& attribute, uint32_t points, absl::string_view name);

class DracoAttributes {
 public:
  // Errors: INVALID_ARGUMENT naming the attribute that the mesh lacks, or that holds no numbers of its kind. The mesh
  // must outlive the result. Sets the flags of the mesh's attributes for their reading.
  static absl::StatusOr<DracoAttributes> Find(draco::Mesh& mesh, const FieldList& wanted);

  uint32_t count() const { return static_cast<uint32_t>(found_.size()); }

  // Reads the number of the n-th requested attribute. Errors: INVALID_ARGUMENT naming point, attribute and limit.
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
