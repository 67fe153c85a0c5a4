#include "client/python/call.h"

#include <pybind11/stl.h>

#include <optional>
#include <utility>
#include <vector>

#include "client/mesh_files/mesh_source.h"
#include "client/python/arguments.h"
#include "client/python/ending.h"
#include "client/python/mesh_arrays.h"
#include "client/python/status.h"
#include "client/tool/cli/remote_files.h"

namespace latvox::client::python {
namespace {

namespace py = pybind11;

constexpr size_t kWaitingBatches = 3;  // then the server waits, too
constexpr char kMeshOfArrays[] = "mesh";

// Returns what reads the mesh of arrays, once.
MeshReader ReaderOf(Mesh arrays, const MeshSource& source) {
  return [mesh = std::make_shared<Mesh>(std::move(arrays)), source]() -> absl::StatusOr<MeshOrDraco> {
    if (absl::Status status = PlaceMesh(source, *mesh); !status.ok()) return status;
    return std::move(*mesh);
  };
}

std::vector<PartArrays> PartsOf(const py::tuple& parts) {
  std::vector<PartArrays> all;
  for (const py::handle part : parts) {
    PartArrays arrays{part.attr("vertices").cast<py::array>(),
                      {},
                      part.attr("sizes").cast<std::optional<py::array>>(),
                      part.attr("colors").cast<py::array>(),
                      part.attr("face_colors").cast<py::array>(),
                      part.attr("name").cast<std::string>(),
                      part.attr("no_color").cast<std::string>()};
    for (const py::handle one : part.attr("faces")) arrays.faces.push_back(one.cast<py::array>());
    all.push_back(std::move(arrays));
  }
  return all;
}

}  // namespace

Connection::Connection(const py::dict& keywords, const std::string& token, const std::string& program) {
  ServerChoice choice = Checked(ParseKeywords(keywords, {kMeshOfArrays})).server;
  Check(CheckProcess());
  choice.program = program;
  choice.credentials.token = token;
  std::optional<Session> opened;
  Run([&](Work& work) {
    auto session = Session::Open(choice, MakeCallOptions(choice, work.cancellation()));
    if (session.ok()) opened = *std::move(session);
    return session.status();
  });
  // The end of a private server takes a moment, in which Python goes on.
  session_.reset(new Session(*std::move(opened)), [process = DeleteInItsProcess()](const Session* session) {
    const WithoutGil without_gil;
    process(session);
  });
}

absl::StatusOr<std::shared_ptr<const Session>> Connection::session() const {
  if (absl::Status status = CheckProcess(); !status.ok()) return status;
  if (session_ == nullptr) return absl::FailedPreconditionError("the client is closed");
  return session_;
}

// Passes each batch on, and waits while too many of them wait.
class Call::Receiver final : public VoxelsOutput {
 public:
  Receiver(Call& call, Work& work) : VoxelsOutput(call.answer_), call_(call), work_(work) {}

  absl::Status Add(const BrickBatch& batch) override {
    const SharedVoxels passed = std::make_shared<Voxels>();
    passed->request = voxels_->request;
    VoxelsOutput output(passed);
    output.SetNames(voxels_->names);
    if (absl::Status status = output.Begin(voxels_->all.accepted); !status.ok()) return status;
    if (absl::Status status = output.Add(batch); !status.ok()) return status;
    const auto has_room = [this] { return call_.batches_.size() < kWaitingBatches; };
    if (absl::Status status = work_.AwaitReady(has_room); !status.ok()) return status;
    work_.Change([&] { call_.batches_.push_back(passed); });
    return absl::OkStatus();
  }

 private:
  Call& call_;
  Work& work_;
};

Call::Call(const Connection& connection, const py::object& mesh, const py::dict& keywords, bool streams)
    : session_(Checked(connection.session())), streams_(streams) {
  if (py::isinstance<py::list>(mesh)) {
    options_ = Checked(ParseKeywords(keywords, mesh.cast<std::vector<std::string>>()));
  } else {
    options_ = Checked(ParseKeywords(keywords, {kMeshOfArrays}));
    Mesh copied = Checked(MeshOfArrays(PartsOf(mesh), {.skip_bad = options_.mesh.skip_bad}));
    read_mesh_ = ReaderOf(std::move(copied), options_.mesh);
  }
  work_.reset(new Work([this](Work& work) { return Voxelize(work); }));
}

absl::Status Call::Voxelize(Work& work) {
  const CallOptions call = MakeCallOptions(options_.server, work.cancellation());
  if (absl::Status status = Align(options_, work.cancellation()); !status.ok()) return status;
  const auto files = RemoteFiles::Fetch(options_, call);
  if (!files.ok()) return files.status();
  answer_->output_options = options_.output_options;
  answer_->is_streamed = streams_;
  JobHooks hooks;
  hooks.connect = [this]() -> absl::StatusOr<const Client*> { return &session_->client(); };
  hooks.on_stage = [](const std::string&) {};
  hooks.on_progress = [&](double share, uint64_t) { work.Change([&] { progress_ = share; }); };
  hooks.say = [](const std::string&) {};  // the answer has all warnings
  hooks.read_mesh = read_mesh_;
  hooks.receive = [&](const VoxelizeRequest& request) -> std::unique_ptr<Output> {
    answer_->request = request;
    if (streams_) return std::make_unique<Receiver>(*this, work);
    return std::make_unique<VoxelsOutput>(answer_);
  };
  (*files)->Hook(hooks);
  auto report = RunJob((*files)->local(), call, hooks);
  if (!report.ok()) return (*files)->Named(report.status());
  (*files)->Name(*report);
  answer_->report = ToJson(*report);
  return absl::OkStatus();
}

SharedVoxels Call::Wait(const py::object& progress) {
  const auto glance = [&] {
    if (progress.is_none()) return;
    double share = 0;
    work_->Change([&] { share = progress_; });
    CallBack(progress, py::make_tuple(share));
  };
  // The call cannot end while it has no room for more batches.
  const auto is_blocked = [this] { return !batches_.empty() && !work_->cancellation().cancelled(); };
  if (work_->Await(is_blocked, glance)) Check(work_->status());
  bool any_left = false;
  work_->Change([&] { any_left = !batches_.empty(); });
  if (any_left) {
    Check(absl::FailedPreconditionError(
        "finish: the stream has batches left; take all of them first, or cancel the call"));
  }
  return answer_;
}

SharedVoxels Call::Next() {
  SharedVoxels next;
  for (bool ended = false; next == nullptr && !ended;) {  // again, if another thread has taken the batch
    ended = work_->Await([this] { return !batches_.empty(); });
    work_->Change([&] {
      if (batches_.empty()) return;
      next = std::move(batches_.front());
      batches_.pop_front();
    });
  }
  if (next == nullptr) Check(work_->status());
  return next;
}

}  // namespace latvox::client::python
