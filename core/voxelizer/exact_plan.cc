#include "core/voxelizer/exact_plan.h"

#include <algorithm>
#include <utility>

#include "absl/strings/str_cat.h"
#include "core/block/fraction_tiles.h"
#include "core/block/solid_tiles.h"
#include "core/solid/balance.h"
#include "core/tiny/fine_pass.h"
#include "core/tiny/fineness.h"
#include "core/triangles/surface_facts.h"
#include "core/voxelizer/job_facts.h"
#include "core/voxelizer/shard.h"

namespace latvox {
namespace {

void SetMargins(ExactPlan& plan) {
  const ExactInput& input = plan.input;
  plan.reach = input.supercover ? input.supercover->ScanReach() : ReachOf(input.frames);
  const TileContext context = plan.Context({});
  plan.near_margin = input.band ? input.band->reach : context.NearMargin();
  plan.far_margin = input.band ? input.band->reach : context.FarMargin();
  const auto widen = [&plan](const Vec3i& by) {
    for (size_t m = 0; m < 3; ++m) {
      plan.near_margin[m] = std::max(plan.near_margin[m], by[m]);
      plan.far_margin[m] = std::max(plan.far_margin[m], by[m]);
    }
  };
  if (input.walk && input.walk->close) widen(input.walk->close->reach + plan.overlap);
  if (plan.HasLinkFields()) widen(plan.LinkContext({}).NearMargin());
  if (plan.HasFraction()) widen(ReachOf(*input.fields->cell));
  if (plan.NeedsNearTriangles()) widen(Shifted(*input.fields->near_reach, kSubvoxelBits) + Vec3i{1, 1, 1});
}

// The distance from the voxels of a tile's scan within which it needs the links of tiny triangles.
Vec3i HaloOfLinks(const ExactPlan& plan) {
  return ReachOf(plan.input.frames) * (plan.minimal ? kNearHalo : plan.link_ends ? 1 : 0);
}

// Voxels around a tile whose links the tile's scan needs.
Vec3i MarginOfLinks(const ExactPlan& plan) {
  Vec3i margin = plan.overlap + HaloOfLinks(plan);
  for (int32_t& voxels : margin) voxels = std::min(voxels, kTileSide / 2);
  return margin;
}

// Whether a walk keeps out of all points near the mesh.
bool ClosesHoles(const ExactPlan& plan) { return plan.input.walk && plan.input.walk->close; }

// Whether tiles need to know tiny triangles, although their links are known. A tile of links may hold only farther ends
// of these, so without the triangles, the tree would leave it out.
bool NeedsTiny(const ExactPlan& plan) {
  return plan.needs_inside || plan.link_ends || plan.HasLinkFields() || ClosesHoles(plan) || plan.NeedsNearTriangles();
}

// The sides need the crossings of lines along an axis, a fraction also those of lines between lattice points, and
// distances need all triangles.
bool NeedsAllTriangles(const ExactPlan& plan) {
  return plan.HasFraction() || (plan.needs_inside && !HasAxes(plan.input.frames)) || ClosesHoles(plan) ||
         plan.NeedsNearTriangles();
}

// The local voxels whose links the job may need.
IndexBox BoxOfLinks(const ExactPlan& plan) {
  const Vec3i margin = plan.Context({}).FarMargin();
  return {plan.scanned().min - margin, plan.scanned().max + margin};
}

// Finds the cells of tiny triangles, the remaining triangles, and the mesh's facts. Nodes that list tiny triangles for
// other ends have no marks for those that a supercover may leave out.
SurfaceFacts SortOutCover(ExactPlan& plan, StopSignal creation) {
  const SnappedMesh& mesh = plan.input.mesh;
  const bool are_boxes = !plan.input.supercover->scan_frames().empty();
  const bool may_be_fine = are_boxes && CanFindTiny(mesh, *plan.links) && !NeedsTiny(plan) && !NeedsAllTriangles(plan);
  if (!may_be_fine || !IsFineForCover(mesh)) return FactsOf(mesh, creation);
  plan.is_fine = true;
  FineTriangles fine = SortOutFineCover(mesh, BoxOfLinks(plan), creation, *plan.links);
  plan.kept = std::move(fine.kept);
  return fine.facts;
}

// Finds the links of tiny triangles, the remaining triangles, and the mesh's facts.
SurfaceFacts SortOut(ExactPlan& plan, StopSignal creation) {
  const ExactInput& input = plan.input;
  if (input.supercover) return SortOutCover(plan, creation);
  // Each label of a labeled walk has a plan of its own.
  const bool may_be_fine = !input.band && !(input.walk && plan.labels);
  const Fineness fineness = may_be_fine ? FinenessOf(input.mesh, plan.scan_frames) : Fineness{};
  if (!fineness.few_touch && !fineness.most_tiny) return FactsOf(input.mesh, creation);
  plan.is_fine = true;
  FineTriangles fine = SortOutFine(input.mesh, plan.scan_frames, fineness, BoxOfLinks(plan), creation, *plan.links,
                                   NeedsTiny(plan) ? &plan.is_tiny : nullptr);
  // Without any triangle or link, the tree would have no tiles, although a walk may reach them.
  const bool has_none = fine.kept.empty() && plan.links->empty();
  const bool needs_all = NeedsAllTriangles(plan) || (input.walk && has_none);
  if (!needs_all) plan.kept = std::move(fine.kept);
  return fine.facts;
}

// Finer tiles begin where the cells of a tile do.
absl::Status AddFinerMesh(ExactPlan& plan, StopSignal creation) {
  const CellPoints& cell = *plan.input.fields->cell;
  auto finer = MakeFinerMesh(plan.input.mesh, cell.n, -cell.low, creation);
  if (!finer.ok()) return finer.status();
  plan.finer = *std::move(finer);
  return absl::OkStatus();
}

const char* WhatNeedsAnInside(const ExactPlan& plan) {
  if (plan.input.fields && plan.input.fields->is_signed) return "signed distances ask for";
  return plan.HasFraction() ? "a fraction asks for" : "a side of links asks for";
}

// Decides on the rule for the inside, unless the set is a solid, which may be open.
absl::Status SetRule(InteriorRule asked, const SurfaceFacts& surface, StopSignal creation, ExactPlan& plan) {
  if (!plan.needs_inside || plan.solid) return absl::OkStatus();
  const bool oriented = asked != InteriorRule::kParity && IsOriented(plan.input.mesh, creation);
  if (creation.Stopped()) return absl::CancelledError("voxelization cancelled");
  const InteriorRule rule = RuleFor(asked, oriented);
  if (rule == InteriorRule::kParity ? !surface.closed : !oriented) {
    return absl::InvalidArgumentError(absl::StrCat("mesh: it is not closed", WithoutOrientation(surface.closed, rule),
                                                   ", which ", WhatNeedsAnInside(plan)));
  }
  plan.facts.interior_rule = rule;
  return absl::OkStatus();
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
  plan->needs_inside = request.needs_inside();
  if (input.walk) plan->overlap = input.walk->steps.reach + input.walk->steps.slack;
  plan->links = std::make_unique<TileLinks>(Shifted(input.mesh.box.min, kTileBits), MarginOfLinks(*plan));
  SetMargins(*plan);
  plan->has_large_tiles = input.band || input.fields;
  if (const std::optional<LabelRequest> asked_labels = request.labels()) {
    const FieldPlan& fields = *input.fields;
    auto labels =
        MakeLabels(input.mesh, *asked_labels, fields.of_vertices, fields.of_mesh.size(), *fields.label_place, creation);
    if (!labels.ok()) return labels.status();
    plan->labels = *std::move(labels);
  }
  const SurfaceFacts surface = SortOut(*plan, creation);
  plan->facts = FactsOfJob(input.mesh, surface, input.region, input.bounds);
  if (input.band) plan->facts.band_width = input.band->width;
  if (input.fields && input.fields->is_searched && !input.fields->near_reach) {
    const FieldPlan& fields = *input.fields;
    plan->index = std::make_unique<TriangleIndex>(input.mesh, fields.metric, creation);
    if (fields.are_numbers) plan->index->SetNumbers(input.mesh, fields.of_vertices, fields.of_mesh.size(), creation);
  }
  if (input.fields && input.fields->fields.Contains(Field::kLabelFractions)) {
    auto labels = FractionLabelsOf(*plan->labels, request.fraction_labels);
    if (!labels.ok()) return labels.status();
    plan->facts.fraction_labels = *std::move(labels);
  }
  if (plan->HasFraction()) {
    if (absl::Status status = AddFinerMesh(*plan, creation); !status.ok()) return status;
  }
  plan->shard = request.part.shard.value_or(Shard{});
  plan->span = SpanOf(request.part, input.mesh, input.frames, input.region, input.bounds, creation);
  if (creation.Stopped()) return absl::CancelledError("voxelization cancelled");
  if (absl::Status status = SetRule(request.interior_rule, surface, creation, *plan); !status.ok()) return status;
  return plan;
}

}  // namespace latvox
