#include "core/voxelizer/exact_plan.h"

#include <algorithm>
#include <utility>

#include "absl/strings/str_cat.h"
#include "core/block/solid_tiles.h"
#include "core/tiny/fine_pass.h"
#include "core/tiny/fineness.h"
#include "core/triangles/surface_facts.h"
#include "core/voxelizer/job_facts.h"
#include "core/voxelizer/shard.h"

namespace latvox {
namespace {

void SetMargins(ExactPlan& plan) {
  const ExactInput& input = plan.input;
  plan.reach = input.supercover ? input.supercover->Margin() : ReachOf(input.frames);
  const TileContext context = plan.Context({});
  plan.near_margin = input.band ? input.band->reach : context.NearMargin();
  plan.far_margin = input.band ? input.band->reach : context.FarMargin();
  if (!plan.HasLinkFields()) return;
  const Vec3i of_links = plan.LinkContext({}).NearMargin();
  for (size_t m = 0; m < 3; ++m) {
    plan.near_margin[m] = std::max(plan.near_margin[m], of_links[m]);
    plan.far_margin[m] = std::max(plan.far_margin[m], of_links[m]);
  }
}

// Whether tiles need to know on which side of the mesh their voxels are.
bool NeedsSides(const ExactPlan& plan) { return plan.solid || plan.NeedsParity(); }

// Whether tiles need to know tiny triangles, although their links are known. A tile of links may hold only farther ends
// of these, so without the triangles, the tree would leave it out.
bool NeedsTiny(const ExactPlan& plan) { return NeedsSides(plan) || plan.link_ends || plan.HasLinkFields(); }

// The sides need the crossings of lines along an axis.
bool NeedsAllTriangles(const ExactPlan& plan) { return NeedsSides(plan) && !HasAxes(plan.input.frames); }

// The distance from a tile within which it needs the links of tiny triangles.
Vec3i HaloOfLinks(const ExactPlan& plan) {
  return ReachOf(plan.input.frames) * (plan.minimal ? kNearHalo : plan.link_ends ? 1 : 0);
}

// Finds the links of tiny triangles, the remaining triangles, and the mesh's facts.
SurfaceFacts SortOut(ExactPlan& plan, StopSignal creation) {
  const ExactInput& input = plan.input;
  const bool may_be_fine = !input.supercover && !input.band;
  const Fineness fineness = may_be_fine ? FinenessOf(input.mesh, plan.scan_frames) : Fineness{};
  if (!fineness.few_touch && !fineness.most_tiny) return FactsOf(input.mesh, creation);
  const Vec3i margin = plan.Context({}).FarMargin();
  const IndexBox around{input.region.min - margin, input.region.max + margin};
  plan.is_fine = true;
  FineTriangles fine = SortOutFine(input.mesh, plan.scan_frames, fineness, around, creation, *plan.links,
                                   NeedsTiny(plan) ? &plan.is_tiny : nullptr);
  if (!NeedsAllTriangles(plan)) plan.kept = std::move(fine.kept);
  return fine.facts;
}

}  // namespace

absl::StatusOr<std::unique_ptr<ExactPlan>> MakeExactPlan(ExactInput asked, const VoxelRequest& request,
                                                         StopSignal creation) {
  auto plan = std::make_unique<ExactPlan>();
  plan->input = std::move(asked);
  const ExactInput& input = plan->input;
  plan->scan_frames = MakeScanFrames(input.frames);
  if (request.solid() != nullptr) plan->solid = *request.solid();
  if (request.links() != nullptr) plan->link_ends = *request.links();
  plan->minimal = request.is_minimal();
  plan->links = std::make_unique<TileLinks>(Shifted(input.mesh.box.min, kTileBits), HaloOfLinks(*plan));
  SetMargins(*plan);
  plan->has_large_tiles = input.band || input.fields;
  const SurfaceFacts surface = SortOut(*plan, creation);
  plan->facts = FactsOfJob(input.mesh, surface, input.region, input.bounds);
  if (input.band) plan->facts.band_width = input.band->width;
  if (input.fields && input.fields->is_searched) {
    plan->index = std::make_unique<const TriangleIndex>(input.mesh, input.fields->metric, creation);
  }
  plan->shard = request.part.shard.value_or(Shard{});
  plan->span = SpanOf(request.part, input.mesh, input.frames, input.region, input.bounds, creation);
  if (creation.Stopped()) return absl::CancelledError("voxelization cancelled");
  if (plan->NeedsParity() && !surface.closed) {
    return absl::InvalidArgumentError(absl::StrCat(
        "mesh: it is not closed, which ",
        input.fields && input.fields->is_signed ? "signed distances ask for" : "a side of links asks for"));
  }
  return plan;
}

}  // namespace latvox
