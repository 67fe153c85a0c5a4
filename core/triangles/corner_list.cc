#include "core/triangles/corner_list.h"

#include <algorithm>

namespace latvox {
namespace {

int16_t Saturated(int32_t x) { return static_cast<int16_t>(std::clamp(x, int32_t{INT16_MIN}, int32_t{INT16_MAX})); }

}  // namespace

void CornerList::SetCorners(size_t place, const std::array<Vec3i, 3>& v, const Vec3i& origin) {
  for (size_t m = 0; m < 3; ++m) {
    const int32_t voxel = v[0][m] >> kSubvoxelBits, low = voxel * kLatticeUnit;
    first_two[place][m] = Saturated(v[0][m] - low);
    first_two[place][4 + m] = Saturated(v[1][m] - low);
    third_and_voxel[place][m] = Saturated(v[2][m] - low);
    third_and_voxel[place][4 + m] = Saturated(voxel - origin[m] + kFirstVoxel);
  }
}

bool CornerList::IsNear(size_t place) const {
  for (size_t n = 1; n < 3; ++n) {  // the first corner is always near
    const Vec3i at = Corner(n, place);
    for (const int32_t x : at) {
      if (x < -kNear || x >= kNear) return false;
    }
  }
  return true;
}

}  // namespace latvox
