#include "core/block/attribute_tiles.h"

#include <memory>
#include <utility>

namespace latvox {
namespace {

std::optional<AttributeContext> MakeContext(const SnappedMesh& mesh, std::optional<CarriedAttributes> carried,
                                            StopSignal stop) {
  if (!carried) return std::nullopt;
  return AttributeContext{mesh, *std::move(carried), stop};
}

}  // namespace

AttributeTiles::AttributeTiles(const SnappedMesh& mesh, std::optional<CarriedAttributes> carried, StopSignal stop)
    : context_(MakeContext(mesh, std::move(carried), stop)) {}

void AttributeTiles::Add(std::span<const uint32_t> triangles, std::span<TileBricks> tiles) const {
  if (!context_) return;
  std::unique_ptr<AttributeScan> scan = scans_.Reserve();
  for (TileBricks& tile : tiles) scan->Find(*context_, triangles, tile);
  if (!context_->stop.Stopped()) scans_.Release(std::move(scan));
}

}  // namespace latvox
