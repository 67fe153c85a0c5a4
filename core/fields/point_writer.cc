// point: the nearest point of the nearest triangle, as the weights of its second and third corner.
#include "core/fields/append.h"
#include "core/fields/field_writer.h"

namespace latvox {
namespace {

class PointWriter final : public FieldWriter {
 public:
  void Append(const Nearest& nearest, std::vector<std::byte>& out) const override {
    const TriangleFeature feature = nearest.shape->FeatureNear(nearest.point);
    for (const double weight : nearest.shape->WeightsNear(nearest.point, feature)) {
      AppendBytes(static_cast<float>(weight), out);
    }
  }
};

}  // namespace

std::unique_ptr<FieldWriter> NewPointWriter(const FieldPlan&, Field) { return std::make_unique<PointWriter>(); }

}  // namespace latvox
