// Voxels as arrays of numpy.
#ifndef LATVOX_CLIENT_PYTHON_VOXELS_H_
#define LATVOX_CLIENT_PYTHON_VOXELS_H_

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <memory>
#include <optional>
#include <string>

#include "client/tool/output/output.h"
#include "latvox/grid/carried_names.h"
#include "latvox/types.h"

namespace latvox::client::python {

// The whole answer of a call, or one batch of it.
struct Voxels {
  VoxelizeRequest request = {};
  OutputOptions output_options = {};
  CarriedNames names = {};   // of parts and materials
  Voxelization all = {};     // of a batch: without a summary
  double progress = 1;       // of the call, when the batch came
  bool is_streamed = false;  // the batches had the voxels, and these are none of them
  std::string report = {};   // that of `latvox voxelize --json`; of a batch: empty
};

// Returns a receiver of a call's answer for all.
class VoxelsOutput : public Output {
 public:
  explicit VoxelsOutput(std::shared_ptr<Voxels> voxels) : voxels_(std::move(voxels)) {}

  void SetNames(const CarriedNames& names) override { voxels_->names = names; }
  absl::Status Begin(const Accepted& accepted) override;
  absl::Status Add(const BrickBatch& batch) override;
  absl::Status Finish(const Summary& summary) override;
  absl::Status Commit() override { return absl::OkStatus(); }

 protected:
  std::shared_ptr<Voxels> voxels_;
};

using SharedVoxels = std::shared_ptr<Voxels>;

// The arrays below that are views belong to the voxels and keep them alive. They are read-only. Without their voxels,
// because batches had them, all functions except CountVoxels and those of names throw FAILED_PRECONDITION.

size_t CountVoxels(const Voxels& voxels);                  // also of the voxels that batches had
std::optional<IndexBox> IndexBoxOf(const Voxels& voxels);  // the smallest box of the voxels
pybind11::array BrickIjk(const SharedVoxels& voxels);      // view, (b, 3) int32: ijk >> 3
pybind11::array BrickMasks(const SharedVoxels& voxels);    // view, (b, 8) uint64: see Brick
pybind11::array Ijk(const Voxels& voxels);                 // copy, (n, 3) int32
pybind11::array Points(const Voxels& voxels);              // copy, (n, 3) float64: world positions of centers
pybind11::list FieldNames(const Voxels& voxels);           // of the fields that they carry
pybind11::list NamesOfField(const Voxels& voxels, const std::string& field);  // by number; empty: there are none
// Returns a view, (n,) or (n, components). Throws KeyError for a field that they do not carry.
pybind11::array FieldArray(const SharedVoxels& voxels, const std::string& field);

// Returns the voxels of [low, high), or of the box that has the call's shape: an array of three dimensions, and its
// lattice point [0, 0, 0]. Its elements are bool, or the values of a field. Throws as ToDense and ShapedBox.
pybind11::tuple Dense(const Voxels& voxels, const std::optional<IndexBox>& box, const std::string& field);

// Writes a file or a remote object, as `latvox voxelize -o` does, and returns its warnings. Throws the errors of
// OpenOutput and RemoteFiles.
//   array   value of --array; empty: that of the call
pybind11::list Save(const Voxels& voxels, const std::string& path, bool dense_npy, const std::string& array,
                    bool allow_http);

}  // namespace latvox::client::python

#endif  // LATVOX_CLIENT_PYTHON_VOXELS_H_
