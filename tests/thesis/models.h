// The algorithms on scanned models: the thesis's bunny (its figures 5.7 to 5.9), and others.
#ifndef LATVOX_TESTS_THESIS_MODELS_H_
#define LATVOX_TESTS_THESIS_MODELS_H_

#include <string>
#include <vector>

#include "core/request/algorithm.h"
#include "core/verify/verify.h"
#include "tests/thesis/experiment.h"

namespace latvox::thesis {

// A lattice that a model's longest side spans.
struct ModelCase {
  LatticeCase lattice_case;
  int32_t size;  // D points a side, on BCC D x D x 2D
  std::string Title() const;
};

// The thesis's three, then the same density with its other neighbourhoods.
std::vector<ModelCase> ModelCases();

struct ModelResult {
  uint64_t voxels = 0;
  Verdict given, rounded;  // as Measurement's
  double seconds = 0;      // on all processors, wall clock
};

// The model's longest side reaches from the first to the last of its D (on BCC 2D) layers, and its low corner is
// lattice point 0. The thesis does not say where its bunny lies.
ModelResult MeasureModel(const TriangleMesh& mesh, const ModelCase& model_case, Algorithm algorithm);

}  // namespace latvox::thesis

#endif  // LATVOX_TESTS_THESIS_MODELS_H_
