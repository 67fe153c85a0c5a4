// The lattice points of a tile inside of the labels of a mesh: see interior.h, for each label by itself.
#ifndef LATVOX_CORE_SOLID_LABELED_INTERIOR_H_
#define LATVOX_CORE_SOLID_LABELED_INTERIOR_H_

#include <cstdint>
#include <memory>
#include <vector>

#include "core/base/stop_signal.h"
#include "core/brick/brick.h"
#include "core/request/solid.h"
#include "core/snap/snap.h"
#include "core/solid/interior.h"
#include "core/solid/labels.h"

namespace latvox {

// Which labels have an inside under a rule, and how many lines along k end unbalanced.
struct LabelBalance {
  InteriorRule rule;              // never kAuto: kWinding if each label is oriented, otherwise kParity for all
  uint64_t unbalanced_lines = 0;  // the sum over all labels
  // Labels that have no inside:
  size_t open_labels = 0;
  uint32_t first_open = kNoLabel;  // the smallest number
  uint64_t first_lines = 0;        // unbalanced lines of first_open
  bool first_closed = false;       // whether it is closed, though not oriented
};

// Counts the lines of all open labels if `force_open` is set, otherwise those of the first one. Once stopped, the
// result is meaningless.
LabelBalance BalanceOfLabels(const SnappedMesh& mesh, const Labels& labels, const Solid& solid, StopSignal stop = {});

// A point is inside if a label contains it. InteriorRows::labels has the label of the lowest rank. Both keep references
// to the mesh and the labels, and the signal.
//
// Precondition: each label is closed (kParity) or oriented (other rules). The rule is not kAuto.
std::unique_ptr<Interior> MakeClosedLabeledInterior(const SnappedMesh& mesh, const Labels& labels, InteriorRule rule,
                                                    const IndexBox& region, StopSignal stop = {});
// For any mesh: each label fills the lines on which it is balanced. Memory: kBytesPerLabeledCrossing for each crossing
// of a line along k.
std::unique_ptr<Interior> MakeOpenLabeledInterior(const SnappedMesh& mesh, const Labels& labels, InteriorRule rule,
                                                  const IndexBox& region, StopSignal stop = {});

inline constexpr uint64_t kBytesPerLabeledCrossing = 2 * kBytesPerLineCrossing;

}  // namespace latvox

#endif  // LATVOX_CORE_SOLID_LABELED_INTERIOR_H_
