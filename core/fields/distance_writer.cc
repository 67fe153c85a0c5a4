// distance: to the mesh, world units.
#include <algorithm>
#include <cmath>

#include "core/fields/append.h"
#include "core/fields/field_writer.h"

namespace latvox {
namespace {

class DistanceWriter final : public FieldWriter {
 public:
  explicit DistanceWriter(const FieldPlan& plan)
      : unit_(plan.unit), most_(static_cast<float>(plan.most_distance)), is_signed_(plan.is_signed) {}

  void Append(const Nearest& nearest, std::vector<std::byte>& out) const override {
    const float distance = std::min(static_cast<float>(std::sqrt(nearest.square) * unit_), most_);
    AppendBytes(is_signed_ && nearest.is_inside && distance != 0 ? -distance : distance, out);
  }

 private:
  const double unit_;
  const float most_;
  const bool is_signed_;
};

}  // namespace

std::unique_ptr<FieldWriter> NewDistanceWriter(const FieldPlan& plan, Field) {
  return std::make_unique<DistanceWriter>(plan);
}

}  // namespace latvox
