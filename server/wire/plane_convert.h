// Converts messages of the plane; see server/wire/convert.h.
#ifndef LATVOX_SERVER_WIRE_PLANE_CONVERT_H_
#define LATVOX_SERVER_WIRE_PLANE_CONVERT_H_

#include <optional>
#include <vector>

#include "absl/status/statusor.h"
#include "core/plane/pixelize.h"
#include "latvox/v1/voxelizer.pb.h"
#include "server/base/errors.h"
#include "server/base/limits.h"

namespace latvox {

struct PlaneJobSpec {
  std::vector<Polyline> polylines;
  PlaneLattice lattice;
  PlaneSampling sampling;
  std::optional<Vec2d> origin;
  PixelizeOptions options;
  RequestFields fields = {};
};

// Checks everything except the points themselves. Errors, all with an ErrorCause: INVALID_ARGUMENT; RESOURCE_EXHAUSTED
// for more points than the limit.
absl::StatusOr<PlaneJobSpec> PlaneJobSpecFromProto(const v1::PixelizeRequest& request, const Limits& limits);

// Returns the number of points in all polylines that are given in full.
uint64_t CountPoints(const v1::PixelizeRequest& request);

// Fills everything except the request's id and time.
v1::PixelizeResponse PixelsToProto(const PlaneJobSpec& spec, const PlaneGrid& grid, const PixelizeResult& result);

}  // namespace latvox

#endif  // LATVOX_SERVER_WIRE_PLANE_CONVERT_H_
