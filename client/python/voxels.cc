#include "client/python/voxels.h"

#include <algorithm>
#include <span>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "client/python/status.h"
#include "client/python/work.h"
#include "client/tool/cli/field_list.h"
#include "client/tool/cli/remote_files.h"
#include "client/tool/cli/shape_options.h"
#include "client/tool/output/box_shape.h"
#include "client/tool/output/field_columns.h"
#include "client/tool/output/outputs.h"
#include "latvox/dense.h"
#include "latvox/error.h"
#include "latvox/for_each_voxel.h"

namespace latvox::client::python {
namespace {

namespace py = pybind11;

// Throws FAILED_PRECONDITION if the caller got the voxels in batches. This answer has none, so a file or an array of it
// would be empty.
void CheckPresent(const Voxels& voxels) {
  if (!voxels.is_streamed) return;
  Check(absl::FailedPreconditionError(
      "the batches of the stream had the voxels, and this answer has none; take them from the batches, or call "
      "voxelize"));
}

// The type that files have, in which -1 means "none".
py::dtype TypeOf(Field field) { return py::dtype(NumpyTypeOf(FactsOf(field).type)); }

// Whether an array has an axis of components: also for a single label, so that programs work for any number of them.
bool HasColumns(const FieldValues& values) { return values.components() != 1 || FactsOf(values.field).is_of_labels(); }

// Returns an object of Python that owns the value.
template <class T>
py::capsule Owner(T value) {
  return py::capsule(new T(std::move(value)), [](void* owned) { delete static_cast<T*>(owned); });
}

py::array ReadOnly(py::array array) {
  array.attr("flags").attr("writeable") = false;
  return array;
}

const FieldValues& Find(const std::vector<FieldValues>& fields, const std::string& name) {
  for (const FieldValues& values : fields) {
    if (NameOf(values.field) == name) return values;
  }
  throw py::key_error(absl::StrCat("voxels carry no field '", name, "'; request it by fields=['", name, "']"));
}

// Returns an array of all voxels, three numbers each.
template <class T, class Visit>
py::array Rows(const Voxels& voxels, const Visit& visit) {
  CheckPresent(voxels);
  py::array_t<T> rows({static_cast<py::ssize_t>(CountVoxels(voxels)), py::ssize_t{3}});
  T* next = rows.mutable_data();
  Run([&](Work& work) {
    for (const Brick& brick : voxels.all.bricks) {
      if (work.cancellation().cancelled()) return absl::CancelledError("cancelled");
      ForEachVoxel(brick, [&](const Vec3i& ijk) { next = std::ranges::copy(visit(ijk), next).out; });
    }
    return absl::OkStatus();
  });
  return rows;
}

// Returns a view of the same member of all bricks.
template <class T, size_t N>
py::array OfBricks(const SharedVoxels& voxels, std::array<T, N> Brick::*member) {
  CheckPresent(*voxels);
  static const Brick kNone{};
  const std::vector<Brick>& bricks = voxels->all.bricks;
  const Brick* const first = bricks.empty() ? &kNone : bricks.data();
  const std::vector<py::ssize_t> shape = {static_cast<py::ssize_t>(bricks.size()), N},
                                 strides = {sizeof(Brick), sizeof(T)};
  return ReadOnly(py::array(py::dtype::of<T>(), shape, strides, (first->*member).data(), Owner(voxels)));
}

// Returns the box of the voxels with the call's shape, as files have it.
absl::StatusOr<IndexBox> BoxOf(const Voxels& voxels) {
  const BoxShape& shape = voxels.output_options.shape;
  const std::optional<IndexBox> box = IndexBoxOf(voxels);
  if (!box && !shape.dims) return IndexBox{};
  return ShapedBox(box.value_or(IndexBox{}), shape, "dense()");
}

}  // namespace

absl::Status VoxelsOutput::Begin(const Accepted& accepted) {
  Voxelization& all = voxels_->all;
  all.accepted = accepted;
  for (const Field field : voxels_->request.fields) all.fields.push_back(accepted.NoValues(field));
  return absl::OkStatus();
}

absl::Status VoxelsOutput::Add(const BrickBatch& batch) {
  Voxelization& all = voxels_->all;
  voxels_->progress = batch.progress;
  all.bricks.insert(all.bricks.end(), batch.bricks.begin(), batch.bricks.end());
  for (FieldValues& values : all.fields) {
    const std::vector<std::byte>& more = FindField(batch.fields, values.field)->bytes;
    values.bytes.insert(values.bytes.end(), more.begin(), more.end());
  }
  return absl::OkStatus();
}

absl::Status VoxelsOutput::Finish(const Summary& summary) {
  voxels_->all.summary = summary;
  return absl::OkStatus();
}

size_t CountVoxels(const Voxels& voxels) {
  if (voxels.is_streamed) return voxels.all.summary.voxels;
  size_t count = 0;
  for (const Brick& brick : voxels.all.bricks) count += client::CountVoxels(brick);
  return count;
}

std::optional<IndexBox> IndexBoxOf(const Voxels& voxels) {
  CheckPresent(voxels);
  VoxelBox box;
  for (const Brick& brick : voxels.all.bricks) box.Add(brick);
  return box.box();
}

py::array BrickIjk(const SharedVoxels& voxels) { return OfBricks(voxels, &Brick::brick_ijk); }

py::array BrickMasks(const SharedVoxels& voxels) { return OfBricks(voxels, &Brick::mask); }

py::array Ijk(const Voxels& voxels) {
  return Rows<int32_t>(voxels, [](const Vec3i& ijk) { return ijk; });
}

py::array Points(const Voxels& voxels) {
  return Rows<double>(voxels, [&grid = voxels.all.accepted.grid](const Vec3i& ijk) { return grid.ToWorld(ijk); });
}

py::list FieldNames(const Voxels& voxels) {
  py::list names;
  for (const FieldValues& values : voxels.all.fields) names.append(NameOf(values.field));
  return names;
}

py::list NamesOfField(const Voxels& voxels, const std::string& field) {
  py::list names;
  for (const std::string& name : voxels.names.Of(Find(voxels.all.fields, field).field)) names.append(name);
  return names;
}

py::array FieldArray(const SharedVoxels& voxels, const std::string& field) {
  CheckPresent(*voxels);
  const FieldValues& values = Find(voxels->all.fields, field);
  const py::ssize_t components = static_cast<py::ssize_t>(values.components());
  std::vector<py::ssize_t> shape = {static_cast<py::ssize_t>(CountVoxels(*voxels))};
  if (HasColumns(values)) shape.push_back(components);
  return ReadOnly(py::array(TypeOf(values.field), shape, values.bytes.data(), Owner(voxels)));
}

py::tuple Dense(const Voxels& voxels, const std::optional<IndexBox>& box, const std::string& field) {
  CheckPresent(voxels);
  std::span<const FieldValues> wanted;
  if (!field.empty()) wanted = {&Find(voxels.all.fields, field), 1};
  const IndexBox whole = box ? *box : Checked(BoxOf(voxels));
  DenseVoxels dense;
  Run([&](Work& work) {
    const BrickBatch all{.bricks = voxels.all.bricks, .fields = wanted};
    auto made = ToDense(all, whole, kMostDensePoints, work.cancellation());
    if (made.ok()) dense = *std::move(made);
    return made.status();
  });
  std::vector<py::ssize_t> shape(dense.shape.begin(), dense.shape.end());
  const py::tuple low = py::make_tuple(dense.box.min[0], dense.box.min[1], dense.box.min[2]);
  if (field.empty()) {
    const uint8_t* const data = dense.voxels.data();
    return py::make_tuple(py::array(py::dtype("?"), shape, data, Owner(std::move(dense.voxels))), low);
  }
  FieldValues& values = dense.fields.front();
  if (HasColumns(values)) shape.push_back(static_cast<py::ssize_t>(values.components()));
  const std::byte* const data = values.bytes.data();
  return py::make_tuple(py::array(TypeOf(values.field), shape, data, Owner(std::move(values.bytes))), low);
}

namespace {

// Writes to the one output of the options.
absl::Status Write(const Voxels& voxels, const VoxelizeOptions& options, const Cancellation& cancellation,
                   std::vector<Warning>& warnings) {
  const auto files = RemoteFiles::Fetch(options, MakeCallOptions(options.server, cancellation));
  if (!files.ok()) return files.status();
  const auto output = (*files)->Open(options.outputs.front(), voxels.request);
  if (!output.ok()) return output.status();
  (*output)->SetNames(voxels.names);
  if (absl::Status status = (*output)->Begin(voxels.all.accepted); !status.ok()) return (*files)->Named(status);
  const auto add = [&](const BrickBatch& batch) { return (*output)->Add(batch); };
  const BrickBatch all{voxels.all.bricks, 1, voxels.all.fields};
  if (absl::Status status = AddInPieces(all, cancellation, add); !status.ok()) return (*files)->Named(status);
  warnings = (*output)->Warnings();
  if (absl::Status status = (*output)->Finish(voxels.all.summary); !status.ok()) return (*files)->Named(status);
  return cancellation.cancelled() ? absl::CancelledError("cancelled") : (*files)->Named((*output)->Commit());
}

// Errors: INVALID_ARGUMENT: the voxels carry no such field; the path's format holds all.
absl::Status SelectArray(const std::string& array, VoxelizeOptions& options) try {
  if (const WrongWord wrong = CheckFieldList(array); !wrong.text.empty()) Refuse("--array: ", wrong.text);
  options.output_options.array = ParseFieldList(array);
  CheckArray(options.request.fields, options.output_options);
  CheckArrayOutput(options.outputs, options.output_options, ToHoldOf(options.request));
  return absl::OkStatus();
} catch (const UsageError& error) {
  return ToStatus(error);
}

// Returns the error with the name of Save's argument.
absl::Status OfPath(absl::Status error) {
  ErrorDetails details = GetErrorDetails(error);
  if (details.field == "--out") details.field = "path";
  SetErrorDetails(details, error);
  return error;
}

}  // namespace

py::list Save(const Voxels& voxels, const std::string& path, bool dense_npy, const std::string& array,
              bool allow_http) {
  CheckPresent(voxels);
  VoxelizeOptions options;
  options.request = voxels.request;
  options.output_options = voxels.output_options;
  options.output_options.dense_npy = dense_npy;
  options.outputs = {path};
  options.remote.allow_http = allow_http;
  Check(OfPath(NameRemoteOutputs(options.outputs, options.remote)));  // first: the query of a URL hides the extension
  if (!array.empty()) Check(SelectArray(array, options));
  std::vector<Warning> warnings;
  RunOnFiles([&](Work& work) { return OfPath(Write(voxels, options, work.cancellation(), warnings)); });
  return ListOf(warnings);
}

}  // namespace latvox::client::python
