// normal: of the nearest triangle, in the world, of length 1.
//
// With B the basis, (B e) x (B f) = cofactor(B) (e x f), and e x f is exact. Entries of the cofactor have an error of
// 2^-51 of the products of basis vectors' lengths. MakeMetric refuses bases for which that would be more than 2^-38 of
// the normal's length. So components are within 2^-25 of the exact ones, which is half a unit of a 32-bit float at 1.
#include <cmath>

#include "core/fields/append.h"
#include "core/fields/field_writer.h"

namespace latvox {
namespace {

class NormalWriter final : public FieldWriter {
 public:
  explicit NormalWriter(const FieldPlan& plan) {
    // Divided first, because products of small or large basis vectors may not be doubles.
    const double size = plan.unit * kLatticeUnit;
    Mat3d basis = plan.basis;
    for (Vec3d& step : basis) step = step * (1 / size);
    for (size_t c = 0; c < 3; ++c) cofactor_[c] = Cross(basis[(c + 1) % 3], basis[(c + 2) % 3]);
  }

  void Append(const Nearest& nearest, std::vector<std::byte>& out) const override {
    Vec3f unit{};
    if (nearest.shape->has_area()) {
      const Vec3d normal = Apply(cofactor_, ToDouble(nearest.shape->normal()));
      const double length = LengthOf(normal);
      for (size_t m = 0; m < 3; ++m) unit[m] = static_cast<float>(normal[m] / length) + 0.0F;  // turns -0 into 0
    }
    AppendBytes(unit, out);
  }

 private:
  Mat3d cofactor_;
};

}  // namespace

std::unique_ptr<FieldWriter> NewNormalWriter(const FieldPlan& plan, Field) {
  return std::make_unique<NormalWriter>(plan);
}

}  // namespace latvox
