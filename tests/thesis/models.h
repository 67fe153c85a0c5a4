// The algorithms on scanned models: the thesis's bunny (figures 5.7 to 5.9), and others.
#ifndef LATVOX_TESTS_THESIS_MODELS_H_
#define LATVOX_TESTS_THESIS_MODELS_H_

#include <string>
#include <vector>

#include "core/request/algorithm.h"
#include "core/verify/verify.h"
#include "tests/thesis/experiment.h"

namespace latvox::thesis {

// A lattice, and the number of points along a model's longest side.
struct ModelCase {
  LatticeCase lattice_case;
  int32_t size;  // D points a side, on BCC D x D x 2D
  std::string Title() const;
};

// Returns the thesis's three cases, then the same density with its other neighborhoods.
std::vector<ModelCase> ModelCases();

struct ModelResult {
  uint64_t voxels = 0;
  Verdict given, rounded;  // as in Measurement
  double seconds = 0;      // on all processors, wall clock
};

// Measures a model. Its longest side reaches from the first to the last of its D layers (2D on BCC), and its low corner
// is lattice point 0. The thesis does not say where its bunny lies.
ModelResult MeasureModel(const TriangleMesh& mesh, const ModelCase& model_case, Algorithm algorithm);

}  // namespace latvox::thesis

#endif  // LATVOX_TESTS_THESIS_MODELS_H_
