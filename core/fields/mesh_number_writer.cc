// part, material, color: numbers of the mesh's vertices.
#include <algorithm>
#include <ranges>

#include "core/fields/append.h"
#include "core/fields/field_writer.h"

namespace latvox {
namespace {

class MeshNumberWriter final : public FieldWriter {
 public:
  MeshNumberWriter(size_t place, Field field) : place_(place), is_color_(field == Field::kColor) {}

  void Append(const Nearest& nearest, std::vector<std::byte>& out) const override {
    const uint32_t number = nearest.numbers[place_];
    if (!is_color_) return AppendBytes(number, out);
    for (const int shift : {16, 8, 0}) out.push_back(static_cast<std::byte>(number >> shift));
  }

 private:
  const size_t place_;  // in Nearest::numbers
  const bool is_color_;
};

}  // namespace

std::unique_ptr<FieldWriter> NewMeshNumberWriter(const FieldPlan& plan, Field field) {
  const auto place = std::ranges::find(plan.of_mesh, field) - plan.of_mesh.begin();
  return std::make_unique<MeshNumberWriter>(static_cast<size_t>(place), field);
}

}  // namespace latvox
