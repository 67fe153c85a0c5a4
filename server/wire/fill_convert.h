// Protocol <-> core: Fill. See server/wire/convert.h.
#ifndef LATVOX_SERVER_WIRE_FILL_CONVERT_H_
#define LATVOX_SERVER_WIRE_FILL_CONVERT_H_

#include <optional>

#include "absl/status/statusor.h"
#include "core/voxelizer/voxelizer.h"
#include "latvox/v1/voxelizer.pb.h"

namespace latvox {

// What spec.fill asks for; nullopt: the surface alone. Errors: INVALID_ARGUMENT with an ErrorCause.
//   algorithm   of the same spec
absl::StatusOr<std::optional<Solid>> SolidFromProto(const v1::VoxelizeSpec& spec, Algorithm algorithm);

v1::FillFacts FillFactsToProto(const Solid& solid, const JobFacts& facts);

}  // namespace latvox

#endif  // LATVOX_SERVER_WIRE_FILL_CONVERT_H_
