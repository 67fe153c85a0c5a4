#include "core/block/field_tiles.h"

#include <memory>
#include <utility>

namespace latvox {
namespace {

std::optional<FieldContext> MakeContext(const SnappedMesh& mesh, const FieldPlan* plan, const TriangleIndex* index,
                                        StopSignal stop) {
  if (plan == nullptr || plan->nearest.empty()) return std::nullopt;
  FieldContext context{mesh, *plan, index, {}, stop};
  for (size_t n = 0; n < plan->fields.size(); ++n) {
    const Field field = plan->fields.view()[n];
    if (FactsOf(field).is_of_nearest()) context.writers.push_back({n, NewFieldWriter(*plan, field)});
  }
  return context;
}

}  // namespace

FieldTiles::FieldTiles(const SnappedMesh& mesh, const FieldPlan* plan, const TriangleIndex* index, StopSignal stop)
    : context_(MakeContext(mesh, plan, index, stop)) {}

void FieldTiles::Add(std::span<const uint32_t> triangles, const Interior* interior, std::span<TileBricks> tiles) const {
  if (!context_) {
    for (TileBricks& tile : tiles) tile.squares = {};
    return;
  }
  std::unique_ptr<FieldScan> scan = scans_.Reserve();
  for (TileBricks& tile : tiles) scan->Find(*context_, triangles, interior, tile);
  if (!context_->stop.Stopped()) scans_.Release(std::move(scan));
}

}  // namespace latvox
