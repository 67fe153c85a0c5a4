// triangle: the number of the nearest triangle in the mesh as sent.
#include "core/fields/append.h"
#include "core/fields/field_writer.h"

namespace latvox {
namespace {

class TriangleWriter final : public FieldWriter {
 public:
  void Append(const Nearest& nearest, std::vector<std::byte>& out) const override {
    AppendBytes(nearest.triangle, out);
  }
};

}  // namespace

std::unique_ptr<FieldWriter> NewTriangleWriter(const FieldPlan&, Field) { return std::make_unique<TriangleWriter>(); }

}  // namespace latvox
