#include "client/internal/field_check.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <variant>

#include "client/internal/broken_protocol.h"

namespace latvox::client {
namespace {

absl::Status CheckDistance(float distance, const VoxelizeRequest& request, const Accepted& accepted) {
  if (!std::isfinite(distance)) return Broken("a distance of ", distance);
  if (const Band* const band = std::get_if<Band>(&request.set)) {
    const double width = std::min(BandWidth(*band, accepted.grid), double{std::numeric_limits<float>::max()});
    if (std::abs(distance) > static_cast<float>(width))
      return Broken("a distance of ", distance, " in a band of ", width);
  }
  if (std::signbit(distance) && !(request.signed_distance && distance < 0)) {
    return Broken("a distance of ", distance, request.signed_distance ? "" : " without signs");
  }
  return absl::OkStatus();
}

}  // namespace

double BandWidth(const Band& band, const GridTransform& grid) {
  return band.in_voxels ? band.width * grid.voxel_size : band.width;
}

// Negated comparisons, to find NaN.
absl::Status CheckFieldValues(const FieldValues& field, const VoxelizeRequest& request, const Accepted& accepted) {
  const auto check = [&](auto of_type, auto&& is_good) {
    for (const auto number : field.As<decltype(of_type)>()) {
      if (!is_good(number)) return Broken("the field ", NameOf(field.field), " has the value ", number);
    }
    return absl::OkStatus();
  };
  const uint64_t triangles = accepted.mesh.triangles;
  switch (field.field) {
    case Field::kPart:
    case Field::kMaterial:
      return check(uint32_t{}, [](uint32_t number) { return number <= 0x7FFFFFFF; });
    case Field::kTriangle:
      return check(uint32_t{}, [=](uint32_t number) { return number < triangles; });
    case Field::kPoint:
      return check(float{}, [](float weight) { return weight >= 0 && weight <= 1; });
    case Field::kNormal:
      return check(float{}, [](float component) { return std::abs(component) <= 1; });
    case Field::kDistance:
      for (const float distance : field.As<float>()) {
        if (absl::Status status = CheckDistance(distance, request, accepted); !status.ok()) return status;
      }
      return absl::OkStatus();
    case Field::kLinks:
      return check(float{}, [](float share) { return std::isnan(share) || (share > 0 && share <= 1); });
    case Field::kLinkTriangles:
      return check(uint32_t{}, [=](uint32_t number) {
        return number < triangles || number == std::numeric_limits<uint32_t>::max();
      });
    case Field::kLinkCrossings:
      return check(uint32_t{}, [=](uint32_t number) { return number <= triangles; });
    case Field::kFraction:
    case Field::kLabelFractions:
      return check(uint16_t{}, [n = uint64_t{request.fraction_n}](uint16_t number) { return number <= n * n * n; });
    case Field::kColor:
      break;  // any bytes
  }
  return absl::OkStatus();
}

}  // namespace latvox::client
