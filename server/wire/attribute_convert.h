// Protocol <-> core: Attribute. See server/wire/convert.h.
#ifndef LATVOX_SERVER_WIRE_ATTRIBUTE_CONVERT_H_
#define LATVOX_SERVER_WIRE_ATTRIBUTE_CONVERT_H_

#include "absl/status/statusor.h"
#include "core/voxelizer/voxelizer.h"
#include "latvox/v1/voxelizer.pb.h"
#include "server/base/mesh_attributes.h"

namespace latvox {

// What spec.attributes asks for. Errors: INVALID_ARGUMENT with an ErrorCause.
//   options   all else of the same spec
absl::StatusOr<MeshAttributes> AttributesFromProto(const v1::VoxelizeSpec& spec, const VoxelizeOptions& options);

v1::AttributeCertificate AttributesToProto(const MeshAttributes& attributes, const JobTotals& totals);

}  // namespace latvox

#endif  // LATVOX_SERVER_WIRE_ATTRIBUTE_CONVERT_H_
